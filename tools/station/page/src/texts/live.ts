export const en = {
  'live.title': 'Live', 'live.filter': 'Filter', 'live.filter-hint': 'press-shop/* or words', 'live.only-bad': 'Only bad',
  'live.bad-first': 'Bad first', 'live.group': 'By device', 'live.shown': '{n} of {all}', 'live.table': 'Channels and their values',
  'live.pin': 'Pin', 'live.quality': 'Quality', 'live.channel': 'Channel', 'live.value': 'Value', 'live.unit': 'Unit', 'live.age': 'Age',
  'live.refresh': 'Refresh', 'live.type': 'Type', 'live.at': 'Address', 'live.none': 'No channel fits the filter.',
  'live.never': 'never', 'live.pin-row': 'Pin {path} on top', 'live.pinned': 'Pinned', 'live.description': 'Description',
};

export const zh: Record<keyof typeof en, string> = {
  'live.title': '实时', 'live.filter': '筛选', 'live.filter-hint': 'press-shop/* 或关键词', 'live.only-bad': '仅异常',
  'live.bad-first': '异常优先', 'live.group': '按设备', 'live.shown': '{n} / {all}', 'live.table': '通道及其数值',
  'live.pin': '置顶', 'live.quality': '质量', 'live.channel': '通道', 'live.value': '数值', 'live.unit': '单位', 'live.age': '时长',
  'live.refresh': '刷新', 'live.type': '类型', 'live.at': '地址', 'live.none': '没有符合筛选的通道。',
  'live.never': '从未', 'live.pin-row': '将 {path} 置顶', 'live.pinned': '已置顶', 'live.description': '说明',
};
