export const en = {
  'overview.title': 'Overview', 'overview.planned': 'Planned', 'overview.measured': 'Measured', 'overview.used': 'Used',
  'overview.planned-hint': 'Share of the wire that the read plan needs',
  'overview.measured-hint': 'Share of the wire that reading took in the last 10 s',
  'overview.used-hint': 'Share of the last second in which the wire was busy or had to be silent',
  'overview.channels': 'Channels', 'overview.bad': 'bad', 'overview.exchanges': 'Exchanges/s', 'overview.misses': 'Missed refreshes',
  'overview.stretch': 'Refreshes stretched by', 'overview.slowest': 'Slowest device', 'overview.no-misses': 'none',
  'overview.last-minute': '+{n} in the last minute', 'overview.bridge': 'Bridge', 'overview.plan': 'Read plan', 'overview.show': 'Channels',
  'overview.none': 'No bus is known yet.', 'overview.none-hint': 'Buses show up here as soon as a bridge of this domain reports them.',
  'overview.used-trend': 'Used in the last five minutes', 'overview.alarms': 'Alarms', 'overview.reopened': 'Port opened anew',
  'overview.report-age': 'Report', 'overview.causes': 'Failed exchanges', 'overview.because': 'because of {cause}',
  'overview.contested': 'Contested: {bridge} also claims to serve a bus of this name. Stop or rename one of them.',
  'overview.refused': '{bridge} has a bus of this name and does not serve it, because this bridge does.',
};

export const zh: Record<keyof typeof en, string> = {
  'overview.title': '总览', 'overview.planned': '计划', 'overview.measured': '实测', 'overview.used': '占用',
  'overview.planned-hint': '读取计划所需的总线时间比例', 'overview.measured-hint': '最近 10 秒读取所占的总线时间比例',
  'overview.used-hint': '最近一秒内总线忙碌或必须静默的时间比例',
  'overview.channels': '通道', 'overview.bad': '异常', 'overview.exchanges': '交换/秒', 'overview.misses': '错过的刷新',
  'overview.stretch': '刷新周期拉长为', 'overview.slowest': '最慢的设备', 'overview.no-misses': '无',
  'overview.last-minute': '最近一分钟 +{n}', 'overview.bridge': '网桥', 'overview.plan': '读取计划', 'overview.show': '通道',
  'overview.none': '尚无总线。', 'overview.none-hint': '此域中的网桥一旦上报，总线就会显示在这里。',
  'overview.used-trend': '最近五分钟的占用', 'overview.alarms': '报警', 'overview.reopened': '端口重新打开',
  'overview.report-age': '报告', 'overview.causes': '失败的交换', 'overview.because': '原因：{cause}',
  'overview.contested': '冲突：{bridge} 也声明服务于同名总线。请停止或重命名其中之一。',
  'overview.refused': '{bridge} 有同名总线，但因本网桥正在服务而未服务该总线。',
};
