export const en = {
  'alarms.title': 'Alarms',
};

export const zh: Record<keyof typeof en, string> = {
  'alarms.title': '报警',
};
