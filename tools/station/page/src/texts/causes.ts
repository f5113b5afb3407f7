// Causes of failed exchanges, values and commands; names as in core/base/cause.cpp.

export const texts = {
  'cause.NONE': ['no error', '无错误'], 'cause.NO_ANSWER': ['no response', '无应答'], 'cause.TRUNCATED': ['incomplete response', '应答中断'],
  'cause.CHECKSUM': ['checksum error', '校验错误'], 'cause.MALFORMED': ['malformed response', '应答格式错误'],
  'cause.FOREIGN': ['answer of another device', '其他设备的应答'], 'cause.OVERLONG': ['answer too long', '应答过长'],
  'cause.PORT_CLOSED': ['port closed', '端口已关闭'], 'cause.PORT_MISSING': ['no such device file', '设备文件不存在'],
  'cause.PORT_DENIED': ['permission denied', '没有权限'], 'cause.PORT_IN_USE': ['in use by another program', '被其他程序占用'],
  'cause.PORT_UNREACHABLE': ['no connection', '无法连接'], 'cause.DEVICE_ERROR': ['refused by the device', '被设备拒绝'],
  'cause.DEVICE_BUSY': ['device not ready', '设备忙'], 'cause.RANGE': ['value out of range', '数值超出范围'],
  'cause.WRONG_TYPE': ['value of the wrong type', '数值类型错误'], 'cause.READ_ONLY': ['channel is read-only', '通道只读'],
  'cause.UNKNOWN_CHANNEL': ['unknown channel', '未知通道'], 'cause.UNKNOWN_DEVICE': ['unknown device', '未知设备'],
  'cause.BAD_ADDRESS': ['no such address', '地址不存在'], 'cause.RAW_NOT_ALLOWED': ['commands to addresses are not allowed', '不允许按地址发命令'],
  'cause.EXPIRED': ['expired before it could run', '执行前已过期'], 'cause.DUPLICATE': ['duplicate of an earlier command', '与之前的命令重复'],
  'cause.QUEUE_FULL': ['too many commands are waiting', '等待的命令过多'], 'cause.RATE_LIMITED': ['written too often', '写入过于频繁'],
  'cause.NOT_VERIFIED': ['the value read back differs', '回读值不一致'], 'cause.LEASED': ['bus is leased to a programming session', '总线已租给编程会话'],
  'cause.OFFLINE': ['device is offline', '设备离线'], 'cause.UNSUPPORTED': ['not supported by the device', '设备不支持'],
  'cause.SHUTDOWN': ['bridge is shutting down', '网桥正在关闭'], 'cause.WRONG_STATE': ['not possible in this state', '此状态下不可执行'],
  'cause.LATE': ['not read in time', '未按时读取'], 'cause.NOT_AVAILABLE': ['the device has no value', '设备没有该数值'],
} as const;
