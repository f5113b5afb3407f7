#include <array>
#include <ostream>

#include "tools/cli/command/base/command.hpp"

namespace fieldcast::cli {

ExitCode usage_fault(std::ostream& err, std::string_view command, std::string_view fault) {
  err << "fieldcast " << command << ": " << fault << '\n';
  return ExitCode::kUsage;
}

std::span<const CommandRow> commands() {
  static const std::array all{
      watch_command(),    write_command(),   acquire_command(), status_command(),
      sessions_command(), plan_command(),    inspect_command(), scan_command(),
      read_command(),     poke_command(),    replay_command(),  sim_check_command(),
      history_command(),  devices_command(), audit_command(),   user_command(),
      token_command(),    alarms_command(),  doctor_command(),  secure_command(),
      standby_command(),  module_command(),  import_command(),  capture_command(),
      health_command(),
  };
  return all;
}

}  // namespace fieldcast::cli
