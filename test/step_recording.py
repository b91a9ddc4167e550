"""A bag of two simulated joints that are driven through steps of their velocity."""
import math
import random

import rosbag
import rospy
from seed import given_seed
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

JOINTS = ["lift", "tilt"]
DEAD_TIME, SLOPES = 0.06, (2.0, 5.0)
SHARES = (1.0, 0.0, -1.0, 0.0, 0.5, 0.0, -0.5, 0.0, 1.0, -1.0, 0.0)
HOLD, STATE_RATE, COMMAND_RATE = 1.0, 200, 50
BEGIN = 1000.0


class Joint:
    """Follows its command after a dead time, at a limited acceleration."""
    def __init__(self, slope):
        self.slope, self.v, self.q, self.most, self.drift = slope, 0.0, 0.0, math.inf, 0.0

    def step(self, wanted, seconds):
        goal = max(-self.most, min(self.most, wanted))
        most = self.slope * seconds
        self.v += max(-most, min(most, goal - self.v))
        self.q += (self.v + self.drift) * seconds


def commands_of(velocity, shares):
    """(time, velocities): one joint after the other."""
    steps = [(0.0, 0.0)] + [(velocity * share, 0.0) for share in shares] + [(0.0, velocity * share) for share in shares]
    for number, velocities in enumerate(steps):
        for tick in range(int(HOLD * COMMAND_RATE)):
            yield number * HOLD + tick / COMMAND_RATE, list(velocities)


def as_array(_, velocities):
    return Float64MultiArray(data=velocities)


def as_trajectory(names, velocities, seconds=0.05):
    """In another order than the joints."""
    point = JointTrajectoryPoint(velocities=velocities[::-1], time_from_start=rospy.Duration(seconds))
    return JointTrajectory(joint_names=names[::-1], points=[point])


def write_steps(path, make=as_array, velocity=0.6, shares=SHARES, names=tuple(JOINTS), change=lambda lift, tilt: None,
                topics=("/jog", "/joint_states"), period=1.0 / STATE_RATE, latency=0.01, ahead=0.0, couple=0.0, uneven=0):
    """`latency`: s from a state to its arrival; `ahead`: of stamps; `couple`: s, of the second joint to the first;
    `uneven`: of so many states one more, whose names and positions differ in number, and of which all repeat a name."""
    noise = random.Random(given_seed())
    joints = [Joint(slope) for slope in SLOPES]
    change(*joints)
    commands = list(commands_of(velocity, shares))
    end, at, nb_states, now, next_state, wanted = commands[-1][0] + HOLD, 0, 0, 0.0, 0.0, (0.0, 0.0)
    with rosbag.Bag(str(path), "w") as bag:
        for time, velocities in commands if topics[0] else []:
            bag.write(topics[0], make(list(names), velocities), rospy.Time.from_sec(BEGIN + time))
        while now < end and topics[1]:
            while at < len(commands) and commands[at][0] + DEAD_TIME <= now:
                wanted, at = commands[at][1], at + 1
            if now >= next_state:
                position = [joint.q + noise.uniform(-1e-4, 1e-4) for joint in joints]
                position[1] += couple * joints[0].v
                state = JointState(name=["other"] + list(names), position=[0.0] + position)
                state.header.stamp = rospy.Time.from_sec(BEGIN + now + ahead)
                if uneven:
                    state.name, state.position = state.name + [names[0]], state.position + [7.0]
                bag.write(topics[1], state, rospy.Time.from_sec(BEGIN + now + latency))
                if uneven and nb_states % uneven == 0:
                    state.name = ["gripper"] + state.name
                    bag.write(topics[1], state, rospy.Time.from_sec(BEGIN + now + latency))
                nb_states, next_state = nb_states + 1, next_state + period
            for joint, velocity_of in zip(joints, wanted):
                joint.step(velocity_of, 0.001)
            now += 0.001
    return path
