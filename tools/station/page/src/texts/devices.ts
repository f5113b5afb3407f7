export const en = {
  'devices.title': 'Devices', 'devices.table': 'Devices and how they are', 'devices.state': 'State', 'devices.device': 'Device', 'devices.reason': 'Reason',
  'devices.answer': 'Answer', 'devices.failed': 'Failed', 'devices.missed': 'Missed', 'devices.none': 'No device is known yet.', 'devices.none-fits': 'No device fits.',
  'devices.unknown': 'No bridge tells of {device}.', 'devices.programmed': 'programmed by {who}', 'devices.bus-closed': 'bus closed: {cause}',
  'devices.bus-leased': 'the bus rests while another device is programmed', 'devices.refuses': 'refuses {n} addresses', 'devices.refuses-one': 'refuses one address', 'devices.not-read': 'nothing was read yet',
  'devices.fine': 'Answers in time.', 'devices.in-maintenance': 'in maintenance', 'devices.end-maintenance': 'End maintenance',
  'devices.timeout': 'Timeout', 'devices.pause': 'Pause', 'devices.exchanges': 'Exchanges', 'devices.failures': 'Failed exchanges', 'devices.retries': 'Retries',
  'devices.learned': 'Learned', 'devices.area': 'Area', 'devices.largest': 'Largest block', 'devices.longest': 'Limit', 'devices.nothing': 'Nothing was learned yet.',
  'devices.refused': 'Refused addresses', 'devices.refused-hint': 'The device answers these with an error. They are tried again from time to time.',
  'devices.gaps': 'Gaps', 'devices.gaps-hint': 'No request reaches across these ranges, since the device refuses that.',
};

export const zh: Record<keyof typeof en, string> = {
  'devices.title': '设备', 'devices.table': '设备及其状态', 'devices.state': '状态', 'devices.device': '设备', 'devices.reason': '原因',
  'devices.answer': '应答', 'devices.failed': '失败', 'devices.missed': '错过', 'devices.none': '尚无设备。', 'devices.none-fits': '没有符合的设备。',
  'devices.unknown': '没有网桥报告 {device}。', 'devices.programmed': '{who} 正在编程', 'devices.bus-closed': '总线已关闭：{cause}',
  'devices.bus-leased': '另一设备编程期间总线暂停', 'devices.refuses': '拒绝 {n} 个地址', 'devices.refuses-one': '拒绝一个地址', 'devices.not-read': '尚未读取',
  'devices.fine': '应答及时。', 'devices.in-maintenance': '维护中', 'devices.end-maintenance': '结束维护',
  'devices.timeout': '超时', 'devices.pause': '间歇', 'devices.exchanges': '交换', 'devices.failures': '失败的交换', 'devices.retries': '重试',
  'devices.learned': '已学习', 'devices.area': '区域', 'devices.largest': '最大块', 'devices.longest': '上限', 'devices.nothing': '尚未学习到任何内容。',
  'devices.refused': '被拒绝的地址', 'devices.refused-hint': '设备对这些地址返回错误。会不时重试。',
  'devices.gaps': '间隙', 'devices.gaps-hint': '设备不允许请求跨越这些范围。',
};
