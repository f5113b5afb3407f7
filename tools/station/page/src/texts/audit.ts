export const en = {
  'audit.title': 'Audit and users',
};

export const zh: Record<keyof typeof en, string> = {
  'audit.title': '审计与用户',
};
