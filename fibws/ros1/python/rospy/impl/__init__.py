"""Where editors find some of rospy's names: scripts import them from here, too."""
