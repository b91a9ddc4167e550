"""What a program that moves the robot asks before each command.

    from collision_pairs.watchdog import Watchdog
    must_stop = Watchdog("collision_pairs_node/in_collision")
    ...
    if must_stop(): ...
"""
import threading
import time

import rospy
from std_msgs.msg import Bool


class Watchdog:
    """True if ~in_collision is, and unless it was heard within the last `timeout` seconds of wall time.

    The rule of twist_mux's locks. What has not been heard yet is not heard: it is true at the start. It can be asked
    from any thread.
    """

    def __init__(self, topic="collision_pairs_node/in_collision", timeout=0.2):
        if not 0.0 < timeout < float("inf"):
            raise ValueError("timeout is %r, but must be a number of seconds above 0" % (timeout,))
        self._timeout = timeout
        self._lock = threading.Lock()
        self._last = None  # (heard at, in collision)
        self._subscriber = rospy.Subscriber(topic, Bool, self._take, queue_size=1, tcp_nodelay=True)

    def _take(self, message):
        with self._lock:
            self._last = time.monotonic(), message.data

    def __call__(self):
        with self._lock:
            last = self._last
        return last is None or last[1] or time.monotonic() - last[0] > self._timeout
