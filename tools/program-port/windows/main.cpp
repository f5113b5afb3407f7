// fieldcast-port.exe: connects a COM port to a PLC behind a bridge while it runs, or as a service.
// Lists the COM ports, and the devices of a bridge.
#include <cstdio>
#include <filesystem>
#include <string_view>
#include <utility>

#include "core/base/json.hpp"
#include "tools/program-port/connection.hpp"
#include "tools/program-port/windows/com_port.hpp"
#include "tools/program-port/windows/service.hpp"

namespace {

using namespace fieldcast;
using Arguments = std::vector<std::string>;

int fail(const std::string& text, int code = port::kTrouble) {
  std::fprintf(stderr, "fieldcast-port: %s\n", text.c_str());
  return code;
}

int list_ports(bool json) {
  const auto ports = port::com_ports();
  for (const port::ComPort& found : ports) {
    const std::string line = json ? Json{{"port", found.name}, {"device", found.device}}.text()
                                  : found.name + "  " + found.device;
    std::printf("%s\n", line.c_str());
  }
  if (ports.empty() && !json) std::puts("this computer has no COM port");
  return port::kStopped;
}

// Parses `connect ...`, as it follows `--`. Returns the exit code of a wrong line.
std::optional<int> parse_connection(const Arguments& words, port::Connection& given) {
  CommandLine line("fieldcast-port service install NAME --", "The command of a service.");
  port::describe_connection(line.command("connect", "Connects a COM port to a PLC"), given);
  std::vector<const char*> argv{"fieldcast-port"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  const auto fault = line.parse_or_print(static_cast<int>(argv.size()), argv.data());
  return fault ? std::optional<int>(*fault ? port::kUsage : port::kStopped) : std::nullopt;
}

// A service starts in a folder of the system and has no terminal.
std::optional<std::string> fault_of_service(const port::Connection& given) {
  if (given.log.empty()) return "a service needs --log FILE";
  for (const std::string& file :
       {given.log, given.password_file, given.authorities, given.certificate, given.key}) {
    if (!file.empty() && !std::filesystem::path(file).is_absolute())
      return "'" + file + "': a service needs the whole path, such as C:\\plc\\" + file;
  }
  return port::fault_of(given);
}

int install(const std::string& name, Arguments words) {
  port::Connection given;
  if (const auto code = parse_connection(words, given)) return *code;
  if (const auto fault = fault_of_service(given)) return fail(*fault, port::kUsage);
  words.insert(words.begin(), {"service", "run", name, "--"});
  if (const auto done = port::install_service(name, words); !done) return fail(done.error());
  std::printf("%s: installed; it starts with Windows, or now by 'net start %s'\n", name.c_str(),
              name.c_str());
  return port::kStopped;
}

int remove(const std::string& name) {
  if (const auto done = port::remove_service(name); !done) return fail(done.error());
  std::printf("%s: removed\n", name.c_str());
  return port::kStopped;
}

int run(const Arguments& words) {
  port::Connection given;
  if (const auto code = parse_connection(words, given)) return *code;
  const auto code = port::run_service([&given]() -> int { return port::run_connection(given); });
  return code ? *code : fail(code.error());
}

}  // namespace

int main(int argc, char** argv) {
  Arguments words(argv + 1, argv + argc), rest;
  std::vector<const char*> first(argv, argv + argc);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] != "--") continue;
    rest.assign(words.begin() + static_cast<std::ptrdiff_t>(i) + 1, words.end());
    first.resize(i + 1);
    break;
  }

  port::Connection given;
  std::string name;
  std::function<int()> chosen;
  const auto choose = [&chosen](CommandLine& command, std::function<int()> what) {
    command.when_given([&chosen, what = std::move(what)]() -> std::optional<CommandLine::Fault> {
      chosen = what;
      return std::nullopt;
    });
  };
  CommandLine line("fieldcast-port",
                   "Connects a COM port to a PLC behind a bridge: programming software opens the "
                   "other end of the pair of ports.");
  CommandLine& connect = line.command("connect", "connects until Ctrl-C, or until a loss");
  port::describe_connection(connect, given);
  choose(connect, [&given] { return static_cast<int>(port::run_connection(given)); });
  CommandLine& list = line.command(
      "list", "shows the COM ports of this computer; with --server, the devices of the bridge");
  port::describe_list(list, given);
  choose(list, [&given] {
    return given.server.empty() ? list_ports(given.json) : static_cast<int>(port::run_list(given));
  });
  CommandLine& service = line.command("service", "connects while Windows runs, without a user");
  const auto of_service = [&](const char* verb, const char* help, std::function<int()> what) {
    CommandLine& command = service.command(verb, help);
    command.text("NAME", name, "name of the service").required();
    choose(command, std::move(what));
  };
  of_service("install", "adds a service; its command follows: -- connect OPTIONS",
             [&] { return install(name, rest); });
  of_service("remove", "stops and removes a service", [&] { return remove(name); });
  of_service("run", "as the service manager starts it", [&] { return run(rest); });
  if (const auto fault = line.parse_or_print(static_cast<int>(first.size()), first.data()))
    return *fault ? port::kUsage : port::kStopped;
  return chosen ? chosen() : port::kUsage;
}
