export const en = {
  'plan.title': 'Read plan',
};

export const zh: Record<keyof typeof en, string> = {
  'plan.title': '读取计划',
};
