"""Clients that ask a node all that it can be asked, at once, and compare what it answers with what must be true.

For the robot of sliding_boxes.urdf: unit boxes a, b and c that slide along x and stand apart.
"""
import random
import threading
import time

import dynamic_reconfigure.client
import rospy
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from collision_pairs.msg import CollisionPairs
from collision_pairs.srv import CheckCollisions, CheckTrajectory
from node_client import NodeClient
from scene_client import SceneClient, add, add_box, attach, box, clear, detach, move, remove, tetrahedron

JOINTS = ["slide_a", "slide_b", "slide_c"]
APART = [0.0, 3.0, 6.0]
FREE, COLLISION, UNKNOWN = CollisionPairs.FREE, CollisionPairs.COLLISION, CollisionPairs.UNKNOWN
ON_TOP_OF_A = (0.0, 0.0, 0.55)  # a box of 0.2 m there is 0.05 m deep in it
NB_FAR = 40                     # objects that come, move and go where no link gets


def collide(positions):
    """Unit boxes on one line."""
    ordered = sorted(positions)
    return any(b - a < 1.0 for a, b in zip(ordered, ordered[1:]))


class Services(threading.local):
    """Each thread has its own: a proxy of rospy 1.15 makes one call at a time."""

    def __init__(self, node):
        self.check = rospy.ServiceProxy(node + "/check_collisions", CheckCollisions)
        self.trajectory = rospy.ServiceProxy(node + "/check_trajectory", CheckTrajectory)
        self.reset = rospy.ServiceProxy(node + "/reset", Trigger)
        self.objects = SceneClient(node)


class StressClients:
    def __init__(self, node, seed):
        self._seed = seed
        self._client = NodeClient(node)
        self._services = Services(node)
        self._parameters = dynamic_reconfigure.client.Client(node, timeout=60)
        self._end = 0.0
        self.counts, self.wrong = {}, []

    def run(self, seconds, pause=0.0, but=()):
        """All of them for so long, with a pause after each call of theirs; without those that are named."""
        self._services.objects.apply(clear())
        assert self._client.next(self._client.reports, lambda report: not report.left_out), "no report of all links"
        self._end = time.time() + seconds
        clients = [self.toggle, self.crowd, self.restricted, self.states, self.trajectories, self.reset,
                   self.reconfigure]
        threads = [threading.Thread(target=self._repeat, args=(client, pause), daemon=True)
                   for client in clients if client.__name__ not in but]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self._services.objects.apply(clear())
        self.counts["reports"] = len(self._client.reports)
        for report in self._client.reports:
            self._expect(report.in_collision == (report.verdict != FREE), "a report's Bool is not its verdict's")

    def _repeat(self, client, pause):
        name = client.__name__
        rng = random.Random("%s %s" % (self._seed, name))
        self.counts[name] = 0
        while time.time() < self._end and not rospy.is_shutdown() and len(self.wrong) < 20:
            try:
                client(rng)
                self.counts[name] += 1
            except Exception as error:  # whatever it is, the test is to say it
                # Of ROS 1's services a connection is lost at times, which dynamic_reconfigure hides; a node that died
                # is noticed by its pid.
                reasons = "%r, after %r" % (error, error.__context__)
                if "transport error" in reasons or "terminated before handshake" in reasons:
                    self.counts["lost connections"] = self.counts.get("lost connections", 0) + 1
                else:
                    self.wrong.append("%s: %s" % (name, reasons))
            time.sleep(pause)

    def _expect(self, holds, what):
        if not holds and len(self.wrong) < 20:
            self.wrong.append(what)

    def _checked(self, **request):
        reply = self._services.check(**request)
        self._expect(reply.success, "check_collisions: " + reply.message)
        return reply.result

    def toggle(self, _):
        """An update is known to the very next request, whatever else goes on."""
        self._services.objects.apply(add_box("toggled", ON_TOP_OF_A))
        there = self._checked()
        self._expect(there.verdict != FREE, "FREE beside an object in contact")
        self._services.objects.apply(remove("toggled"))
        gone = self._checked()
        self._expect(gone.verdict != COLLISION, "COLLISION without the object: %s" % gone.pairs)
        known = (there.verdict, gone.verdict) == (COLLISION, FREE)
        self.counts["known"] = self.counts.get("known", 0) + known

    def crowd(self, rng):
        """Objects far away that stand still, and one on the other side that c carries; some changes are refused."""
        name = "far_%d" % rng.randrange(NB_FAR)
        at = (rng.uniform(-9, 9), rng.uniform(20, 40), rng.uniform(-9, 9))
        change = rng.choice([add_box(name, at), move(name, at), remove(name),
                             add(name, at, primitives=[box(0.1, 0.1, 0.1)], meshes=[tetrahedron(0.3)]),
                             add_box("carried", (0, -30, 0)), attach("carried", "c"), detach("carried")])
        self._services.objects.send(change, no_list=rng.random() < 0.5)

    def restricted(self, rng):
        """Only pairs with the link that is asked for; c may carry another."""
        link = rng.choice("ab")
        for pair in self._checked(links=[link]).pairs:
            self._expect(link in (pair.first_link, pair.second_link), "a pair that was not asked for")

    def states(self, rng):
        """Hypothetical states, away from the toggled object: all poses are the request's own."""
        positions = [rng.uniform(2.0, 8.0) for _ in JOINTS]
        verdict = self._checked(joint_state=JointState(name=JOINTS, position=positions)).verdict
        self._expect(verdict == (COLLISION if collide(positions) else FREE), "state %s: %d" % (positions, verdict))

    def trajectories(self, rng):
        points = [[rng.uniform(2.0, 8.0) for _ in JOINTS] for _ in range(10)]
        reply = self._services.trajectory(between=True, verdict_only=True, trajectory=JointTrajectory(
            joint_names=JOINTS, points=[JointTrajectoryPoint(positions=point) for point in points]))
        self._expect(reply.success, "check_trajectory: " + reply.message)
        truth = [COLLISION if collide(point) else FREE for point in points]
        self._expect(list(bytearray(reply.verdict)) == truth, "trajectory %s: %s, not %s; %s" % (
            points, list(bytearray(reply.verdict)), truth, reply.unknown_because))

    def reset(self, _):
        reply = self._services.reset()
        self._expect(reply.success, "reset: " + reply.message)
        time.sleep(0.05)

    def reconfigure(self, rng):
        self._parameters.update_configuration({
            "alarm_distance": rng.choice([0.0, 0.05, 0.5]), "fidelity": rng.choice(["aabb", "obb", "convex", "mesh"]),
            "rate": rng.choice([50.0, 200.0, 1000.0]), "min_distance": rng.random() < 0.5,
            "show_only_investigated_boxes": rng.random() < 0.5})
        time.sleep(0.05)
