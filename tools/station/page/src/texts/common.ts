// Texts of the page frame, and the words of the station.

export const texts = {
  'nav.label': ['Pages', '页面'], skip: ['To the content', '跳到内容'], logout: ['Log out', '退出登录'], cancel: ['Cancel', '取消'], close: ['Close', '关闭'],
  loading: ['Loading …', '加载中…'], theme: ['Colours', '颜色'], 'theme.system': ['Auto', '自动'], 'theme.light': ['Light', '浅色'],
  'theme.dark': ['Dark', '深色'], language: ['Language', '语言'], connecting: ['Connecting …', '正在连接…'], connected: ['Live', '实时'],
  'lost.title': ['Connection lost for {age}', '连接已中断 {age}'],
  'lost.text': ['Nothing here is current. Trying again in {again}.', '此处数据均非当前值。{again} 后重试。'], 'line.rate': ['{n} values/s', '{n} 值/秒'],
  'line.channels': ['{n} channels', '{n} 个通道'], 'line.bad': ['{n} bad', '{n} 个异常'], 'role.viewer': ['viewer', '查看者'],
  'role.operator': ['operator', '操作员'], 'role.programmer': ['programmer', '编程员'], 'role.engineer': ['engineer', '工程师'], 'keys.title': ['Keys', '快捷键'],
  'keys.filter': ['To the filter', '转到筛选框'], 'keys.rows': ['Up and down in a table', '在表格中上下移动'], 'keys.open': ['Open the row', '打开该行'],
  'keys.leave': ['Leave a field or a dialog', '离开输入框或对话框'], 'keys.help': ['This list', '显示此列表'],
  'error.lost': ['The station does not answer.', '监控站没有响应。'],
  'error.no-result': ['No result came. Look at the value before you try again.', '没有收到结果。请先查看当前值再重试。'], 'quality.good': ['good', '良好'],
  'quality.uncertain': ['uncertain', '不确定'], 'quality.bad-no-answer': ['no response', '无应答'], 'quality.bad-frame': ['bad frame', '报文错误'],
  'quality.bad-device-error': ['device error', '设备报错'], 'quality.bad-range': ['out of range', '超出范围'],
  'quality.bad-configuration': ['bad configuration', '配置错误'], 'quality.not-yet-read': ['not yet read', '尚未读取'], 'state.opening': ['opening', '正在打开'],
  'state.running': ['running', '运行'], 'state.closed': ['closed', '已关闭'], 'state.leased': ['leased', '已租出'], 'state.stopped': ['stopped', '已停止'],
  'state.unknown': ['unknown', '未知'], 'state.online': ['online', '在线'], 'state.degraded': ['degraded', '降级'], 'state.offline': ['offline', '离线'],
  'access.read-only': ['read only', '只读'], 'access.read-write': ['read and write', '读写'], 'access.write-only': ['write only', '只写'],
  'mode.intensive': ['intensive', '密集'], 'mode.scheduled': ['scheduled', '定时'], 'mode.on-demand': ['on demand', '按需'], 'result.done': ['done', '已执行'],
  'result.verified': ['written and read back', '已写入并回读'], 'result.rejected': ['rejected', '被拒绝'], 'result.failed': ['failed', '失败'],
  'result.expired': ['expired', '已过期'],
} as const;
