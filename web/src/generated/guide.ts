// Made by tools/gen_player.py from src/distal/render/guide.py: change that, and run it.

export const PREFIX = "View_";
export const GOAL_PREFIX = "Goal_";
export const ACTION = "Guide_action";
export const SIZE = "Guide_size";
export const ACTIONS = ["go", "frame", "front", "back", "right", "left", "top", "bottom"] as const;
export const NUMBERS = ["yaw", "pitch", "zoom", "panX", "panY", "arrived", "clearance", "opening", "height", "eyeX", "eyeY", "eyeZ", "targetX", "targetY", "targetZ", "upX", "upY", "upZ"] as const;
