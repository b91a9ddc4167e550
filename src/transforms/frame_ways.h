// Ways from one frame to others: by transforms, and where TF lacks them by fixed joints.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "collision_pairs/input_error.h"
#include "transform_buffer.h"

namespace collision_pairs {

/// Which pose of each frame.
struct Instant {
  enum Kind {
    AT,     ///< at the stamp
    NEWEST  ///< the newest one when the clock is at the stamp
  };
  Kind kind;
  StampNs stamp;
};

/// No stamp can help: TF does not connect two frames.
class NotConnected : public InputError {
 public:
  using InputError::InputError;
};

/// The links of a robot as frames. Those that no transform names have numbers, too, which change
/// when the buffer has more frames.
class LinkFrames {
 public:
  struct Link {
    std::string name;
    int body;
    Eigen::Isometry3d X_BL;
  };
  /// Of each body its first link comes before the others. The buffer must outlive this object; it
  /// is not read yet, since scenes are built while transforms arrive.
  LinkFrames(const TransformBuffer& buffer, std::vector<Link> links);
  /// To be called before the others: finds links that transforms have named since.
  void update();

  /// -1: neither a frame of the buffer nor a link.
  int find(const std::string& name) const;
  std::size_t nbFrames() const { return nb_named_ + links_.size(); }
  bool isNamed(int frame) const { return frame < static_cast<int>(nb_named_); }
  /// -1: not a link.
  int bodyOf(int frame) const {
    return frame < 0 || by_frame_[frame] < 0 ? -1 : linkOf(frame).body;
  }
  const std::vector<int>& ofBody(int body) const { return of_bodies_[body]; }
  const Eigen::Isometry3d& X_BL(int frame) const { return linkOf(frame).X_BL; }

 private:
  const Link& linkOf(int frame) const { return links_[by_frame_[frame]]; }

  const TransformBuffer* buffer_;
  std::vector<Link> links_;
  std::size_t nb_named_ = 0;  ///< frames of the buffer
  std::vector<int> by_frame_;
  std::vector<std::vector<int>> of_bodies_;
};

/// Ways from one frame to others at one instant, as far as they are known. A link from which
/// transforms do not lead to the target hangs on a link of the same body from which they do.
/// Nothing is known if the target hangs on itself.
class FrameWays {
 public:
  /// `target` may be -1, to which no way leads. `links`: null for transforms only.
  FrameWays(const TransformBuffer& buffer, int target, const Instant& instant,
            const LinkFrames* links = nullptr);

  struct Way {
    bool is_known = false;
    /// Stamps of the transforms on the way but static ones, also of one that leads nowhere.
    StampNs oldest = NEVER, newest = EVER_SINCE;
    bool is_settled = true;  ///< transforms only, and the static ones among them can never change
    int anchor = 0;          ///< by fixed joints, from this one on by transforms
    int top = -1;            ///< … up to here, and from here down to the frame
  };
  Way to(int source) const;
  /// Of a known way. Throws InputError if tf2 does not know it.
  Eigen::Isometry3d poseOf(int source, const Way& way, StampNs stamp) const {
    return poseOf(source, way.anchor, way.top, stamp);
  }
  /// Why to() is not known, in words.
  std::string whyNot(int source) const;
  /// False if its ancestors end at one that TF does not place anywhere, or never.
  bool isPlaced(int frame) const;
  bool isInCycle(int frame) const { return is_in_cycle_ || lastAncestor(frame) < 0; }
  /// On what a frame hung, known or suspect, when it was last heard of; -1: that is too long ago.
  int lastParent(int frame) const;
  int target() const { return target_; }
  /// At NEWEST, of the frames asked about so far: the stamp of the newest transform that is not
  /// known, up to now. Bodies may have been found by another way, which ends or was sent earlier.
  StampNs newestUnknown() const { return newest_unknown_; }

 private:
  /// A frame that a fixed joint places at `via`, and from which transforms lead on.
  struct Anchor {
    int frame, via;
    int before;  ///< from which transforms lead to `via`; -1: it is the target
    int top;     ///< … up to here, and from here down to `via`
  };

  struct Placed {
    int top;
    Eigen::Isometry3d X_TF;  ///< T: the top
  };

  /// False: it is not known.
  bool step(int frame, StampNs& stamp, int& parent) const;
  Eigen::Isometry3d poseOf(int source, int anchor, int top, StampNs stamp) const;
  Eigen::Isometry3d poseBelow(int top, int frame, StampNs stamp) const;
  void pass(int frame, StampNs stamp, Way& way) const;
  void passFixedJoint(int from, int to, Way& way) const;
  /// The first of some frames on the way of transforms up from one, known or suspect; -1: none.
  int firstAbove(int frame, const std::vector<int>& frames) const;
  const std::vector<int>& linksFixedTo(int frame) const;
  /// All ways up from a frame, noted as far as they are known. False: one leads back to itself.
  /// `path`: from the target to the frame; `done`: frames from which all ways have been gone.
  bool goUp(int frame, Way way, std::vector<int>& path, std::vector<int>& done) const;
  bool isBack(int frame, const std::vector<int>& path) const;
  bool isBelow(int link, const std::vector<int>& path) const;
  /// The last ancestor that can be reached; -1: they form a cycle.
  int lastAncestor(int frame) const;
  /// Up to a frame that has been asked about, but no further than tf2 walks.
  Way climb(int frame, std::size_t nb_steps) const;
  /// The same, but for the first step by its own transform.
  Way stepUp(int frame, std::size_t nb_steps) const;

  const TransformBuffer& buffer_;
  const LinkFrames* links_;
  int target_;
  Instant instant_;
  bool is_in_cycle_ = false;  ///< the target
  mutable StampNs newest_unknown_ = EVER_SINCE;
  mutable std::vector<Anchor> anchors_;
  // Of the frames that were asked about, not of all: a look-up costs the same among any number.
  mutable std::unordered_map<int, Way> noted_;
  mutable StampNs placed_at_ = NEVER;
  mutable std::unordered_map<int, Placed> placed_;  ///< by frame
};

struct FoundPose {
  Eigen::Isometry3d X_TS = Eigen::Isometry3d::Identity();
  StampNs oldest = NEVER;  ///< NEVER: of static transforms only
};
/// Pose of one frame in another, and the stamps on the way. At NEWEST: at the newest instant that
/// all transforms on the way have reached. Throws NotConnected, or InputError if that instant is
/// missing.
FoundPose poseBetween(const TransformBuffer& buffer, const std::string& target,
                      const std::string& source, Instant instant,
                      const LinkFrames* links = nullptr);

}  // namespace collision_pairs
