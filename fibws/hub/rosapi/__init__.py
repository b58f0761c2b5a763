"""The hub's own nodes: rosapi's services, /rosout_agg, and who is connected."""
