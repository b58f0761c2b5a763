// An action over topics, as ROS 1 has it, is five topics that share one name.

const PARTS = ["goal", "cancel", "status", "feedback", "result"];

export const actionTopics = (action: string): string[] => PARTS.map((part) => `${action}/${part}`);
