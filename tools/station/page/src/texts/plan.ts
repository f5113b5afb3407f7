export const en = {
  'plan.title': 'Read plan', 'plan.bus': 'Bus', 'plan.picture': 'Reads of {bus} in time', 'plan.load': 'Load of the wire',
  'plan.free': 'Free on the wire', 'plan.overload': '{share} too much', 'plan.table': 'Repeats after', 'plan.no-table': 'no timetable',
  'plan.groups': 'Groups', 'plan.reads': '{groups} groups, {reads} reads', 'plan.stretch': 'Refreshes', 'plan.no-stretch': 'as asked for', 'plan.since': 'In force since',
  'plan.wire': 'Wire', 'plan.all-groups': 'all groups', 'plan.every': 'every {period}', 'plan.when-due': 'when due', 'plan.in': 'Zoom in', 'plan.out': 'Zoom out',
  'plan.none': 'No plan is known of {bus}.', 'plan.none-hint': 'A bridge tells its plan when it runs the bus. A bridge of an older version tells none.',
  'plan.no-groups': 'Nothing is read on this bus.',
  'plan.read': 'Read', 'plan.read-of': '{n} of {of}', 'plan.ends': 'Ends at', 'plan.takes': 'Takes', 'plan.period': 'Period', 'plan.slack': 'Slack',
  'plan.gap': 'Longest gap', 'plan.share': 'Share of the wire', 'plan.request': 'Request', 'plan.list': 'a list of ranges', 'plan.block': 'one block',
  'plan.channels': 'Channels in this read: {n}',
};

export const zh: Record<keyof typeof en, string> = {
  'plan.title': '读取计划', 'plan.bus': '总线', 'plan.picture': '{bus} 的读取时间图', 'plan.load': '总线负载',
  'plan.free': '总线空闲', 'plan.overload': '超出 {share}', 'plan.table': '重复周期', 'plan.no-table': '无时间表',
  'plan.groups': '组', 'plan.reads': '{groups} 组，{reads} 次读取', 'plan.stretch': '刷新周期', 'plan.no-stretch': '与要求一致', 'plan.since': '生效于',
  'plan.wire': '总线', 'plan.all-groups': '所有组', 'plan.every': '每 {period}', 'plan.when-due': '按需', 'plan.in': '放大', 'plan.out': '缩小',
  'plan.none': '{bus} 没有已知的计划。', 'plan.none-hint': '网桥运行该总线时会报告其计划。旧版本的网桥不报告。',
  'plan.no-groups': '此总线上没有读取任何内容。',
  'plan.read': '读取', 'plan.read-of': '第 {n} / {of} 次', 'plan.ends': '结束于', 'plan.takes': '用时', 'plan.period': '周期', 'plan.slack': '余量',
  'plan.gap': '最长间隔', 'plan.share': '总线占比', 'plan.request': '请求', 'plan.list': '地址范围列表', 'plan.block': '一个连续块',
  'plan.channels': '此次读取的通道：{n}',
};
