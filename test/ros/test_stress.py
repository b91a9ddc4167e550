#!/usr/bin/python3
"""All services of a node at once, from several clients: it lives on, and every answer is right.

COLLISION_PAIRS_STRESS_SECONDS says for how long (default 8).
"""
import os
import sys
import unittest
import xmlrpc.client

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.dirname(HERE)]

import rosgraph
import rosnode
import rospy
import rostest

from node_client import JointPublisher
from seed import given_seed
from stress_clients import APART, JOINTS, StressClients

SECONDS = float(os.environ.get("COLLISION_PAIRS_STRESS_SECONDS", 8))


def pid_of_node():
    uri = rosnode.get_api_uri(rosgraph.Master("/test"), "/busy")
    return xmlrpc.client.ServerProxy(uri).getPid("/test")[2]


class StressTest(unittest.TestCase):
    def test_under_all_requests_at_once_the_node_lives_on_and_every_answer_is_right(self):
        robot = JointPublisher(JOINTS)
        robot.hold(APART)
        clients = StressClients("/busy", given_seed())
        pid = pid_of_node()
        clients.run(SECONDS)
        print(clients.counts)
        self.assertEqual(clients.wrong, [])
        self.assertEqual(pid_of_node(), pid)
        for name, count in clients.counts.items():
            self.assertGreater(count, 0, name)


if __name__ == "__main__":
    rospy.init_node("test_stress")
    rostest.rosrun("collision_pairs", "stress", StressTest)
