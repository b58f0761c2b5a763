"""rospy's internal modules, as far as scripts import them."""
