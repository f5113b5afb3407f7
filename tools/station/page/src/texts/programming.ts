export const en = {
  'programming.title': 'Programming',
};

export const zh: Record<keyof typeof en, string> = {
  'programming.title': '编程',
};
