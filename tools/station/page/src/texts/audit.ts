export const en = {
  'audit.title': 'Audit', 'audit.entries': 'Entries', 'audit.users': 'Users', 'audit.what': 'What', 'audit.target': 'Target', 'audit.result': 'Result',
  'audit.bytes': 'Bytes to / from', 'audit.none': 'Nobody did anything in this time.', 'audit.not-allowed': 'This page needs the role operator.',
  'audit.user': 'User', 'audit.role': 'Role', 'audit.may': 'May', 'audit.since': 'Since', 'audit.no-users': 'There are no users.',
  'audit.users-hint': 'Users and tokens are changed on the station’s machine only, by these commands:',
  'what.write': 'write', 'what.acquire': 'read now', 'what.login': 'login', 'what.logout': 'logout', 'what.program': 'program', 'what.acknowledge': 'acknowledge',
  'what.shelve': 'shelve', 'what.unshelve': 'unshelve', 'what.maintenance': 'maintenance', 'what.end maintenance': 'end maintenance',
  'what.command': 'command', 'what.user add': 'add user', 'what.user remove': 'remove user',
  'may.viewer': 'look', 'may.operator': 'look, write, acknowledge', 'may.programmer': 'look, write, acknowledge, program devices',
};

export const zh: Record<keyof typeof en, string> = {
  'audit.title': '审计', 'audit.entries': '记录', 'audit.users': '用户', 'audit.what': '操作', 'audit.target': '对象', 'audit.result': '结果',
  'audit.bytes': '字节 发送/接收', 'audit.none': '此时段内没有任何操作。', 'audit.not-allowed': '此页面需要操作员角色。',
  'audit.user': '用户', 'audit.role': '角色', 'audit.may': '权限', 'audit.since': '创建于', 'audit.no-users': '没有用户。',
  'audit.users-hint': '用户和令牌只能在监控站所在的机器上用以下命令更改：',
  'what.write': '写入', 'what.acquire': '立即读取', 'what.login': '登录', 'what.logout': '退出', 'what.program': '编程', 'what.acknowledge': '确认报警',
  'what.shelve': '搁置报警', 'what.unshelve': '取消搁置', 'what.maintenance': '开始维护', 'what.end maintenance': '结束维护',
  'what.command': '命令', 'what.user add': '添加用户', 'what.user remove': '删除用户',
  'may.viewer': '查看', 'may.operator': '查看、写入、确认', 'may.programmer': '查看、写入、确认、设备编程',
};
