#include "tools/program-port/windows/service.hpp"

#include <fmt/format.h>
#include <windows.h>

#include <memory>
#include <system_error>
#include <utility>

#include "tools/program-port/windows/stop_requests.hpp"

namespace fieldcast::port {
namespace {

constexpr DWORD kStopSeconds = 30;

struct CloseService {
  void operator()(SC_HANDLE handle) const { ::CloseServiceHandle(handle); }
};
using Handle = std::unique_ptr<std::remove_pointer_t<SC_HANDLE>, CloseService>;

tl::unexpected<std::string> fault(const std::string& name, DWORD error) {
  if (error == ERROR_ACCESS_DENIED)
    return tl::unexpected(name + ": needs the rights of an administrator");
  if (error == ERROR_SERVICE_EXISTS) return tl::unexpected(name + ": this service exists already");
  if (error == ERROR_SERVICE_DOES_NOT_EXIST)
    return tl::unexpected(name + ": there is no service of this name");
  return tl::unexpected(
      fmt::format("{}: {}", name, std::system_category().message(static_cast<int>(error))));
}

// Quoted so that CommandLineToArgvW returns the argument: backslashes before a quote are doubled.
std::string quoted(const std::string& argument) {
  std::string text = "\"";
  std::size_t backslashes = 0;
  for (const char c : argument) {
    if (c == '"') text.append(backslashes + 1, '\\');
    backslashes = c == '\\' ? backslashes + 1 : 0;
    text.push_back(c);
  }
  return text.append(backslashes, '\\') + '"';
}

std::string program_path() {
  std::string path(32768, '\0');
  path.resize(::GetModuleFileNameA(nullptr, path.data(), static_cast<DWORD>(path.size())));
  return path;
}

// Of the service of this process. The service manager calls the functions below on its threads.
SERVICE_STATUS_HANDLE reporter = nullptr;
std::function<int()> session_of_service;
int exit_code = 0;

void report(DWORD state, DWORD code = 0) {
  SERVICE_STATUS status{};
  status.dwServiceType = SERVICE_WIN32_OWN_PROCESS;
  status.dwCurrentState = state;
  status.dwControlsAccepted =
      state == SERVICE_RUNNING ? SERVICE_ACCEPT_STOP | SERVICE_ACCEPT_SHUTDOWN : 0;
  status.dwWin32ExitCode = code == 0 ? NO_ERROR : ERROR_SERVICE_SPECIFIC_ERROR;
  status.dwServiceSpecificExitCode = code;
  status.dwWaitHint = kStopSeconds * 1000;
  ::SetServiceStatus(reporter, &status);
}

DWORD WINAPI on_control(DWORD control, DWORD, void*, void*) {
  if (control != SERVICE_CONTROL_STOP && control != SERVICE_CONTROL_SHUTDOWN)
    return control == SERVICE_CONTROL_INTERROGATE ? NO_ERROR : ERROR_CALL_NOT_IMPLEMENTED;
  report(SERVICE_STOP_PENDING);
  request_stop();
  return NO_ERROR;
}

void WINAPI service_main(DWORD, char**) {
  char name[] = "";  // the process has one service
  reporter = ::RegisterServiceCtrlHandlerExA(name, on_control, nullptr);
  report(SERVICE_RUNNING);
  exit_code = session_of_service();
  report(SERVICE_STOPPED, static_cast<DWORD>(exit_code));
}

}  // namespace

tl::expected<void, std::string> install_service(const std::string& name,
                                                const std::vector<std::string>& arguments) {
  std::string command = quoted(program_path());
  for (const std::string& argument : arguments) command += ' ' + quoted(argument);
  const Handle manager(::OpenSCManagerA(nullptr, nullptr, SC_MANAGER_CREATE_SERVICE));
  if (!manager) return fault(name, ::GetLastError());
  const Handle service(::CreateServiceA(
      manager.get(), name.c_str(), ("Fieldcast port " + name).c_str(), SERVICE_ALL_ACCESS,
      SERVICE_WIN32_OWN_PROCESS, SERVICE_AUTO_START, SERVICE_ERROR_NORMAL, command.c_str(), nullptr,
      nullptr, nullptr, "NT AUTHORITY\\LocalService", nullptr));
  if (!service) return fault(name, ::GetLastError());
  return {};
}

tl::expected<void, std::string> remove_service(const std::string& name) {
  const Handle manager(::OpenSCManagerA(nullptr, nullptr, SC_MANAGER_CONNECT));
  if (!manager) return fault(name, ::GetLastError());
  const Handle service(
      ::OpenServiceA(manager.get(), name.c_str(), SERVICE_STOP | SERVICE_QUERY_STATUS | DELETE));
  if (!service) return fault(name, ::GetLastError());
  SERVICE_STATUS status{};
  if (::ControlService(service.get(), SERVICE_CONTROL_STOP, &status)) {
    for (DWORD tenths = 0; tenths < kStopSeconds * 10; ++tenths) {
      if (!::QueryServiceStatus(service.get(), &status) || status.dwCurrentState == SERVICE_STOPPED)
        break;
      ::Sleep(100);
    }
  }
  if (!::DeleteService(service.get())) return fault(name, ::GetLastError());
  return {};
}

tl::expected<int, std::string> run_service(std::function<int()> session) {
  session_of_service = std::move(session);
  ignore_console();
  char name[] = "";
  const SERVICE_TABLE_ENTRYA services[] = {{name, service_main}, {nullptr, nullptr}};
  if (!::StartServiceCtrlDispatcherA(services))
    return tl::unexpected(
        std::string("only the service manager of Windows starts it like this; "
                    "use 'connect', or 'net start NAME'"));
  return exit_code;
}

}  // namespace fieldcast::port
