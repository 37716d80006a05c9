"""The physical robot: its model in the plant and the systems between commands and physics."""
