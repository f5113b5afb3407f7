// Causes of failed exchanges, values and commands; names as in core/base/cause.cpp.

export const en = {
  'cause.NONE': 'no error', 'cause.NO_ANSWER': 'no response', 'cause.TRUNCATED': 'incomplete response', 'cause.CHECKSUM': 'checksum error',
  'cause.MALFORMED': 'malformed response', 'cause.FOREIGN': 'answer of another device', 'cause.OVERLONG': 'answer too long',
  'cause.PORT_CLOSED': 'port closed', 'cause.PORT_MISSING': 'no such device file', 'cause.PORT_DENIED': 'permission denied',
  'cause.PORT_IN_USE': 'in use by another program', 'cause.PORT_UNREACHABLE': 'no connection', 'cause.DEVICE_ERROR': 'refused by the device',
  'cause.DEVICE_BUSY': 'device not ready', 'cause.RANGE': 'value out of range', 'cause.WRONG_TYPE': 'value of the wrong type', 'cause.READ_ONLY': 'channel is read-only',
  'cause.UNKNOWN_CHANNEL': 'unknown channel', 'cause.UNKNOWN_DEVICE': 'unknown device', 'cause.BAD_ADDRESS': 'no such address',
  'cause.RAW_NOT_ALLOWED': 'commands to addresses are not allowed', 'cause.EXPIRED': 'expired before it could run', 'cause.DUPLICATE': 'duplicate of an earlier command',
  'cause.QUEUE_FULL': 'too many commands are waiting', 'cause.RATE_LIMITED': 'written too often', 'cause.NOT_VERIFIED': 'the value read back differs',
  'cause.LEASED': 'bus is leased to a programming session', 'cause.OFFLINE': 'device is offline', 'cause.UNSUPPORTED': 'not supported by the device',
  'cause.SHUTDOWN': 'bridge is shutting down', 'cause.WRONG_STATE': 'not possible in this state', 'cause.LATE': 'not read in time',
  'cause.NOT_AVAILABLE': 'the device has no value',
};

export const zh: Record<keyof typeof en, string> = {
  'cause.NONE': '无错误', 'cause.NO_ANSWER': '无应答', 'cause.TRUNCATED': '应答中断', 'cause.CHECKSUM': '校验错误',
  'cause.MALFORMED': '应答格式错误', 'cause.FOREIGN': '其他设备的应答', 'cause.OVERLONG': '应答过长',
  'cause.PORT_CLOSED': '端口已关闭', 'cause.PORT_MISSING': '设备文件不存在', 'cause.PORT_DENIED': '没有权限',
  'cause.PORT_IN_USE': '被其他程序占用', 'cause.PORT_UNREACHABLE': '无法连接', 'cause.DEVICE_ERROR': '被设备拒绝',
  'cause.DEVICE_BUSY': '设备忙', 'cause.RANGE': '数值超出范围', 'cause.WRONG_TYPE': '数值类型错误', 'cause.READ_ONLY': '通道只读',
  'cause.UNKNOWN_CHANNEL': '未知通道', 'cause.UNKNOWN_DEVICE': '未知设备', 'cause.BAD_ADDRESS': '地址不存在',
  'cause.RAW_NOT_ALLOWED': '不允许按地址发命令', 'cause.EXPIRED': '执行前已过期', 'cause.DUPLICATE': '与之前的命令重复',
  'cause.QUEUE_FULL': '等待的命令过多', 'cause.RATE_LIMITED': '写入过于频繁', 'cause.NOT_VERIFIED': '回读值不一致',
  'cause.LEASED': '总线已租给编程会话', 'cause.OFFLINE': '设备离线', 'cause.UNSUPPORTED': '设备不支持',
  'cause.SHUTDOWN': '网桥正在关闭', 'cause.WRONG_STATE': '此状态下不可执行', 'cause.LATE': '未按时读取',
  'cause.NOT_AVAILABLE': '设备没有该数值',
};
