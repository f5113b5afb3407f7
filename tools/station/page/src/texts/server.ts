// Messages of station and bridge, as they are written there, and their Chinese. {} is a part that differs; the parts keep their order.

export const messages: readonly (readonly [en: string, zh: string])[] = [
  // Logins and rights
  ['wrong user or password', '用户名或密码错误'], ['too many wrong passwords', '密码错误次数过多'], ['try again in {} s', '请在 {} 秒后重试'],
  ['login required', '需要登录'], ['not allowed', '没有权限'], ['your role may not do this; ask for another role', '您的角色无权执行此操作；请申请其他角色'],
  ['there are no users', '没有用户'], ['the station needs a store', '监控站需要存储'],
  // Requests
  ['try again', '请重试'], ['try again later', '请稍后重试'], ['ask again in a second', '请在一秒后重试'], ['the database does not respond', '数据库没有响应'],
  ['too many others ask the database', '数据库请求过多'], ['too many requests wait for bridges', '等待网桥的请求过多'], ['the store is not available now', '存储当前不可用'],
  // Configuration
  ['no bridge serves the bus; it was not sent', '没有网桥服务于此总线；未发送'], ['no result came in time', '未按时收到结果'],
  ["is the bridge running, and does its file have 'configure: { allow: true }' and its identity the right (fieldcast secure renew)?",
    '网桥是否在运行，其文件是否含有 “configure: { allow: true }”，其身份是否有此权限（fieldcast secure renew）？'],
  ["this bridge does not allow changes from here; an administrator writes 'configure: { allow: true }' in its file", '此网桥不允许从这里修改；管理员须在其文件中写入 “configure: { allow: true }”'],
  ['this station has no right to configurations', '此监控站无权访问配置'], ['the bridge sent no valid reply', '网桥的应答无效'], ['is it older than the station?', '其版本是否早于监控站？'],
  ["the bus '{}' does not run on this bridge", '总线 “{}” 未在此网桥上运行'], ['deploy the bus first, without the new device', '请先部署不含新设备的总线'],
  ['the configuration has faults', '配置有错误'], ['correct the faults', '请改正错误'],
  ['a protected key differs: {}', '受保护的键被修改：{}'], ['restore its lines', '请恢复这些行'],
  ['the version {} of {} is still watched', '{1} 的版本 {0} 仍在观察中'],
  ['confirm it or roll it back first, or wait for the end of the watch', '请先确认或恢复，或等待观察结束'],
  ['the bridge is starting or reloading', '网桥正在启动或重新加载'], ['the text does not differ from the file', '文本与文件相同'],
  ['this version is not watched', '此版本未在观察中'], ['it was kept, confirmed or rolled back already', '它已被保留、确认或恢复'],
  ['the configuration was changed meanwhile, last by {}', '配置已被修改，最后由 {} 修改'], ['the configuration was changed meanwhile', '配置已被修改'],
  ['compare your text with the present one, and deploy again', '请与当前文本比较后重新部署'],
  // Scan and first values
  ['another engineer reads first values on this bus', '另一位工程师正在此总线上读取首批数值'],
  ["no device of the bus '{}' has the protocol '{}'", '总线 “{}” 没有协议为 “{}” 的设备'], ['choose a protocol and addresses of this bus', '请选择此总线的协议和地址'],
  ['addresses of {} are {} to {}', '{} 的地址为 {} 至 {}'], ['the addresses of {} are not numbers that can be searched', '{} 的地址不是可扫描的数字'], ['first or last is not an address', '起始或结束不是地址'],
  ['the reads of the plan left no free time of {} (timeout) in time; give the device a shorter timeout, or read it later',
    '计划的读取未及时留出 {}（timeout）的空闲时间；请给设备设置更短的 timeout，或稍后读取'],
  // Commands
  ["channel '{}' is read-only; its configuration would have to say access: read-write", '通道 “{}” 只读；其配置须写明 access: read-write'],
  ["channel '{}' is write-only; its configuration would have to say access: read-write", '通道 “{}” 只写；其配置须写明 access: read-write'],
  ['{} is below the lowest value allowed, {} (write: min)', '{} 低于允许的最小值 {}（write: min）'], ['{} is above the highest value allowed, {} (write: max)', '{} 高于允许的最大值 {}（write: max）'],
  ["channel '{}' is calculated by the bridge; only its inputs can be requested", '通道 “{}” 由网桥计算；只能请求其输入'], ["device '{}' has no channel '{}'", '设备 “{}” 没有通道 “{}”'],
  ['the alarm was raised again since then', '此后报警再次触发'],
];
