"""What there is: nodes, topics, services, actions, parameters, and who has to do with them."""
