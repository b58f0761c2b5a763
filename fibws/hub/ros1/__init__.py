"""ROS 1 nodes in the graph: the master's and the slaves' XML-RPC APIs, and TCPROS."""
