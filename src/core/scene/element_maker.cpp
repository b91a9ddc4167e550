#include <algorithm>
#include <set>
#include <string_view>

#include "in_parallel.h"
#include "scene_element.h"
#include "sphere_cover.h"

// Meshes that scenes share.
namespace collision_pairs {
namespace {

constexpr std::uint64_t KEPT_ROUNDS = 16;  // a mesh that this many scenes did not use is dropped

template <class T>
std::string_view bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::uint64_t hashOf(const TriangleMesh& mesh) {
  std::uint64_t hash = mesh.vertices.size();
  for (const std::string_view part :
       {std::string_view(mesh.name), bytesOf(mesh.vertices), bytesOf(mesh.triangles)}) {
    hash = hash * 0x9e3779b97f4a7c15u + std::hash<std::string_view>()(part);
  }
  return hash;
}

bool areSame(const TriangleMesh& a, const TriangleMesh& b) {
  return a.name == b.name && bytesOf(a.vertices) == bytesOf(b.vertices) &&
         bytesOf(a.triangles) == bytesOf(b.triangles);
}

}  // namespace

PreparedElements ElementMaker::prepare(const std::vector<std::pair<const Shape*, Fidelity>>& wanted,
                                       const SceneSettings& settings) {
  PreparedElements all;
  all.max_hull_vertices_ = settings.max_hull_vertices;
  all.method_ = settings.narrow_phase;
  std::vector<Job> jobs;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& [shape, needed] : wanted) {
      const auto* mesh = std::get_if<Mesh>(shape);
      if (mesh == nullptr) continue;
      auto& of_scene = all.meshes_[{mesh->mesh.get(), needed}];
      if (of_scene) continue;
      if (jobs.empty()) ++round_;
      const auto content = contentOf(mesh->mesh);
      auto& prepared =
          prepared_[Key(content.get(), needed, settings.max_hull_vertices, settings.narrow_phase)];
      if (!prepared) prepared = std::make_shared<Prepared>();
      prepared->content = content;
      prepared->last_round = round_;
      of_scene = {prepared, &prepared->element};
      jobs.push_back({shape, needed, content, prepared});
    }
  }
  if (jobs.empty()) return all;
  make(jobs, settings);
  drop();
  return all;
}

void ElementMaker::make(std::vector<Job> jobs, const SceneSettings& settings) {
  std::set<const Prepared*> seen;  // two links may have meshes of the same content
  const auto isDone = [&](const Job& job) {
    const std::lock_guard<std::mutex> lock(job.prepared->making);
    return !seen.insert(job.prepared.get()).second || job.prepared->is_made;
  };
  jobs.erase(std::remove_if(jobs.begin(), jobs.end(), isDone), jobs.end());
  std::mutex telling;
  std::size_t done = 0;
  inParallel(nbThreads(0, jobs.size()), jobs.size(), [&](std::size_t, std::size_t i) {
    const Job& job = jobs[i];
    {
      const std::lock_guard<std::mutex> lock(job.prepared->making);
      if (!job.prepared->is_made) {  // not by another scene in the meantime
        job.prepared->element = makeElement(*job.shape, job.needed, settings.max_hull_vertices,
                                            settings.narrow_phase, job.content->spheres);
        job.prepared->is_made = true;
      }
    }
    if (!settings.progress) return;
    const std::lock_guard<std::mutex> lock(telling);
    settings.progress(++done, jobs.size());
  });
}

std::shared_ptr<const ElementMaker::Content> ElementMaker::contentOf(const MeshPtr& mesh) {
  Known& known = by_address_[mesh.get()];
  known.last_round = round_;
  if (known.mesh) return known.content;
  known.mesh = mesh;
  const std::uint64_t hash = hashOf(*mesh);
  const auto [begin, end] = by_hash_.equal_range(hash);
  const auto same = std::find_if(
      begin, end, [&](const auto& entry) { return areSame(*entry.second->mesh, *mesh); });
  if (same != end) return known.content = same->second;
  const Content content{mesh, std::make_shared<const FineSpheres>(Mesh{mesh})};
  known.content = std::make_shared<const Content>(content);
  by_hash_.emplace(hash, known.content);
  return known.content;
}

// The rungs are shared by all scenes that hold them.
void ElementMaker::drop() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto isOld = [&](std::uint64_t last_round) { return last_round + KEPT_ROUNDS <= round_; };
  std::set<const Content*> kept;
  for (auto i = prepared_.begin(); i != prepared_.end();) {
    Prepared& prepared = *i->second;
    const auto isHeldByAScene = [&] {
      const std::lock_guard<std::mutex> its_lock(prepared.making);
      return prepared.element.rungs.use_count() > 1;
    };
    if (isOld(prepared.last_round) && i->second.use_count() == 1 && !isHeldByAScene()) {
      i = prepared_.erase(i);
    } else {
      kept.insert(std::get<0>((i++)->first));
    }
  }
  for (auto i = by_address_.begin(); i != by_address_.end();) {
    i = isOld(i->second.last_round) ? by_address_.erase(i) : std::next(i);
  }
  for (auto i = by_hash_.begin(); i != by_hash_.end();) {
    i = kept.count(i->second.get()) == 0 ? by_hash_.erase(i) : std::next(i);
  }
}

SceneElement PreparedElements::make(const Shape& shape, Fidelity needed) const {
  if (const auto* mesh = std::get_if<Mesh>(&shape)) {
    const auto found = meshes_.find({mesh->mesh.get(), needed});
    if (found != meshes_.end()) return *found->second;
  }
  return makeElement(shape, needed, max_hull_vertices_, method_);
}

}  // namespace collision_pairs
