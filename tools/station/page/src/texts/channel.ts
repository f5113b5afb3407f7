export const en = {
  'channel.title': 'Channel', 'channel.unknown': 'There is no channel {path}.',
  'channel.unknown-hint': 'It may come back with its bridge. Look for it on the page Live.',
  'channel.age': 'Age', 'channel.type': 'Type', 'channel.at': 'Address', 'channel.access': 'Access', 'channel.mode': 'Mode',
  'channel.refresh': 'Refresh', 'channel.bridge': 'Bridge', 'channel.limits': 'Limits', 'channel.no-limits': 'none',
  'channel.trend': 'Trend of {path}', 'channel.span': 'Shown span', 'channel.no-trend': 'A text has no trend. Its last values:',
  'channel.no-store': 'This station keeps no history: the trend begins when the page is opened.',
  'channel.write': 'Write', 'channel.new-value': 'New value', 'channel.verify': 'Read back', 'channel.confirm-title': 'Write this value?',
  'channel.from-to': '{from} becomes {to}', 'channel.read-now': 'Read now', 'channel.results': 'Results',
  'channel.took': '{time} after {took}', 'channel.range': '{min} to {max}', 'channel.bad-number': 'This is no number for {type}.',
  'channel.out-of-range': 'The value must be {range}.', 'channel.waiting': 'waiting …', 'channel.read': 'read',
  'channel.history': 'Open in History', 'channel.needs-operator': 'Writing needs the role operator.',
  'channel.pause': 'Zoomed', 'channel.follow': 'Back to now', 'channel.missed': 'missed refreshes',
};

export const zh: Record<keyof typeof en, string> = {
  'channel.title': '通道', 'channel.unknown': '没有通道 {path}。',
  'channel.unknown-hint': '它可能随网桥恢复。请在“实时”页面查找。',
  'channel.age': '时长', 'channel.type': '类型', 'channel.at': '地址', 'channel.access': '访问', 'channel.mode': '模式',
  'channel.refresh': '刷新', 'channel.bridge': '网桥', 'channel.limits': '限值', 'channel.no-limits': '无',
  'channel.trend': '{path} 的趋势', 'channel.span': '显示时段', 'channel.no-trend': '文本没有趋势。最近的值：',
  'channel.no-store': '此监控站不保存历史：趋势从打开页面时开始。',
  'channel.write': '写入', 'channel.new-value': '新值', 'channel.verify': '回读', 'channel.confirm-title': '写入此值？',
  'channel.from-to': '{from} 改为 {to}', 'channel.read-now': '立即读取', 'channel.results': '结果',
  'channel.took': '{time}，用时 {took}', 'channel.range': '{min} 到 {max}', 'channel.bad-number': '这不是 {type} 的有效数值。',
  'channel.out-of-range': '该值必须在 {range} 之间。', 'channel.waiting': '等待中…', 'channel.read': '已读取',
  'channel.history': '在历史中打开', 'channel.needs-operator': '写入需要操作员角色。',
  'channel.pause': '已缩放', 'channel.follow': '回到当前', 'channel.missed': '错过的刷新',
};
