export const en = {
  'channel.title': 'Channel',
};

export const zh: Record<keyof typeof en, string> = {
  'channel.title': '通道',
};
