export const en = {
  'login.title': 'Log in', 'login.user': 'User', 'login.password': 'Password', 'login.go': 'Log in',
  'login.wrong': 'User or password is wrong.', 'login.wait': 'Too many tries. Wait {n} s.',
  'login.hint': 'Users are made on the machine of the station: fieldcast user add',
};

export const zh: Record<keyof typeof en, string> = {
  'login.title': '登录', 'login.user': '用户', 'login.password': '密码', 'login.go': '登录',
  'login.wrong': '用户名或密码错误。', 'login.wait': '尝试次数过多。请等待 {n} 秒。',
  'login.hint': '用户在监控站主机上创建：fieldcast user add',
};
