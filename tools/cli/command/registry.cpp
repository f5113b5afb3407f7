#include <array>
#include <ostream>

#include "tools/cli/command/base/command.hpp"

namespace fieldcast::cli {

// Each is defined in the file of its command.
CommandEntry watch_command();
CommandEntry write_command();
CommandEntry acquire_command();
CommandEntry status_command();
CommandEntry sessions_command();
CommandEntry plan_command();
CommandEntry inspect_command();
CommandEntry read_command();
CommandEntry poke_command();
CommandEntry scan_command();
CommandEntry import_command();
CommandEntry sim_check_command();
CommandEntry history_command();
CommandEntry devices_command();
CommandEntry audit_command();
CommandEntry user_command();
CommandEntry token_command();
CommandEntry alarms_command();
CommandEntry doctor_command();
CommandEntry secure_command();
CommandEntry standby_command();
CommandEntry module_command();
CommandEntry capture_command();

ExitCode usage_fault(std::ostream& err, std::string_view command, std::string_view fault) {
  err << "fieldcast " << command << ": " << fault << '\n';
  return ExitCode::kUsage;
}

std::span<const CommandEntry> commands() {
  static const std::array all{
      watch_command(),    write_command(),  acquire_command(),   status_command(),
      sessions_command(), plan_command(),   inspect_command(),   scan_command(),
      read_command(),     poke_command(),   sim_check_command(), history_command(),
      devices_command(),  audit_command(),  user_command(),      token_command(),
      alarms_command(),   doctor_command(), secure_command(),    standby_command(),
      module_command(),   import_command(), capture_command(),
  };
  return all;
}

}  // namespace fieldcast::cli
