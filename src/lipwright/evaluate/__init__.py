"""Values against values: how well a predicted face follows a real one."""
