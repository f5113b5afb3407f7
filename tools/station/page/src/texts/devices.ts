export const en = {
  'devices.title': 'Devices',
};

export const zh: Record<keyof typeof en, string> = {
  'devices.title': '设备',
};
