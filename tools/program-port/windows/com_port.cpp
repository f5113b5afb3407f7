#include "tools/program-port/windows/com_port.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/windows/stream_handle.hpp>
#include <optional>
#include <utility>

#include "core/base/message_text.hpp"
#include "tools/program-port/local_port.hpp"

namespace fieldcast::port {
namespace {

namespace asio = boost::asio;

std::string text_of(DWORD error) {
  return boost::system::error_code(static_cast<int>(error), boost::system::system_category())
      .message();
}

class ComStream final : public ByteStream {
 public:
  explicit ComStream(asio::windows::stream_handle handle) : handle_(std::move(handle)) {}
  void read_some(asio::mutable_buffer into, Done done) override {
    handle_.async_read_some(into, std::move(done));
  }
  void write_some(asio::const_buffer from, Done done) override {
    handle_.async_write_some(from, std::move(done));
  }
  std::size_t queued() const override { return 0; }
  void close() override {
    // A driver may keep a request of a closed handle until the port receives a byte.
    if (handle_.is_open()) ::PurgeComm(handle_.native_handle(), PURGE_RXABORT | PURGE_TXABORT);
    boost::system::error_code ignored;
    handle_.close(ignored);
  }

 private:
  asio::windows::stream_handle handle_;
};

class ComLocalPort final : public LocalPort {
 public:
  ComLocalPort(HANDLE handle, std::string remark) : handle_(handle), remark_(std::move(remark)) {}
  ~ComLocalPort() override {
    if (handle_ != INVALID_HANDLE_VALUE) ::CloseHandle(handle_);
  }
  ComLocalPort(const ComLocalPort&) = delete;
  ComLocalPort& operator=(const ComLocalPort&) = delete;

  // Drops bytes that the software sent before: their request has timed out.
  std::unique_ptr<ByteStream> stream(asio::io_context& io) override {
    if (handle_ == INVALID_HANDLE_VALUE) return nullptr;
    ::PurgeComm(handle_, PURGE_RXCLEAR);
    asio::windows::stream_handle handle(io);
    boost::system::error_code fault;
    handle.assign(handle_, fault);
    if (fault) return nullptr;
    handle_ = INVALID_HANDLE_VALUE;
    return std::make_unique<ComStream>(std::move(handle));
  }
  std::string remark() const override { return remark_; }
  // The settings of the software are those of the other end of the pair.
  std::optional<program::LineSettings> settings() const override { return std::nullopt; }

 private:
  HANDLE handle_;  // INVALID_HANDLE_VALUE: the stream owns it
  std::string remark_;
};

// Without flow control, because it would keep bytes of a binary protocol.
bool set_up(HANDLE handle, const program::LineSettings& line) {
  DCB settings{};
  settings.DCBlength = sizeof settings;
  if (!::GetCommState(handle, &settings)) return false;
  if (line.baud != 0) settings.BaudRate = line.baud;
  if (line.data_bits != 0) {
    settings.ByteSize = line.data_bits;
    settings.Parity = line.parity == Parity::kEven  ? EVENPARITY
                      : line.parity == Parity::kOdd ? ODDPARITY
                                                    : NOPARITY;
    settings.StopBits = line.stop_bits == 2 ? TWOSTOPBITS : ONESTOPBIT;
  }
  settings.fBinary = TRUE;
  settings.fParity = FALSE;
  settings.fErrorChar = settings.fNull = settings.fAbortOnError = FALSE;
  settings.fOutX = settings.fInX = settings.fOutxCtsFlow = settings.fOutxDsrFlow = FALSE;
  settings.fDsrSensitivity = FALSE;
  settings.XonChar = 0x11;  // drivers refuse equal characters, even without flow control
  settings.XoffChar = 0x13;
  settings.fDtrControl = DTR_CONTROL_ENABLE;
  settings.fRtsControl = RTS_CONTROL_ENABLE;
  if (!::SetCommState(handle, &settings)) return false;
  // A read ends 1 ms after the last byte, and waits for the first one; a write has no limit.
  COMMTIMEOUTS limits{};
  limits.ReadIntervalTimeout = 1;
  return ::SetCommTimeouts(handle, &limits) != 0;
}

std::string known_ports() {
  std::string text;
  for (const ComPort& port : com_ports()) text += (text.empty() ? "" : ", ") + port.name;
  return text.empty() ? "this computer has none" : "this computer has " + text;
}

std::string opening_fault(const std::string& name, DWORD error) {
  if (error == ERROR_FILE_NOT_FOUND || error == ERROR_PATH_NOT_FOUND)
    return fmt::format("{}: there is no such COM port; {}", name, known_ports());
  if (error == ERROR_ACCESS_DENIED || error == ERROR_SHARING_VIOLATION)
    return fmt::format(
        "{}: a program has opened it; use the end of the pair that the programming software does "
        "not open",
        name);
  return fmt::format("{}: cannot be opened: {}", name, text_of(error));
}

std::optional<unsigned> number_of(const std::string& name) {
  if (name.size() < 4 || name.size() > 7 || ::_strnicmp(name.c_str(), "COM", 3) != 0)
    return std::nullopt;
  unsigned number = 0;
  for (const char c : name.substr(3)) {
    if (c < '0' || c > '9') return std::nullopt;
    number = number * 10 + static_cast<unsigned>(c - '0');
  }
  return number == 0 ? std::nullopt : std::optional(number);
}

}  // namespace

const LocalPortOption kLocalPortOption{
    "--port",
    "the COM port, such as COM5: of a pair of virtual ports, the end that the programming software "
    "does not open",
    "the programming software may open the port"};

tl::expected<std::unique_ptr<LocalPort>, std::string> open_local_port(
    const std::string& name, const program::LineSettings& line) {
  if (!number_of(name))
    return tl::make_unexpected(
        fmt::format("'{}' is not a COM port; expected for example COM5", escaped(name)));
  // Ports above COM9 need this prefix.
  const HANDLE handle = ::CreateFileA(("\\\\.\\" + name).c_str(), GENERIC_READ | GENERIC_WRITE, 0,
                                      nullptr, OPEN_EXISTING, FILE_FLAG_OVERLAPPED, nullptr);
  if (handle == INVALID_HANDLE_VALUE)
    return tl::make_unexpected(opening_fault(name, ::GetLastError()));
  const bool complete = set_up(handle, line);
  // A virtual port may have no data bits and parity; the line of the bridge has them anyway.
  if (!complete && !set_up(handle, {.baud = line.baud})) {
    const std::string reason = text_of(::GetLastError());
    ::CloseHandle(handle);
    return tl::make_unexpected(
        fmt::format("{}: the driver refuses its settings: {}", name, reason));
  }
  return std::make_unique<ComLocalPort>(
      handle, complete ? ""
                       : name +
                             " keeps its own data bits, parity and stop bits: its driver "
                             "refuses those of --line, which the line of the PLC has");
}

std::vector<ComPort> com_ports() {
  std::vector<ComPort> ports;
  HKEY key = nullptr;
  if (::RegOpenKeyExA(HKEY_LOCAL_MACHINE, "HARDWARE\\DEVICEMAP\\SERIALCOMM", 0, KEY_READ, &key) !=
      ERROR_SUCCESS)
    return ports;
  for (DWORD index = 0;; ++index) {
    char device[256], name[256];
    DWORD device_size = sizeof device, name_size = sizeof name - 1, type = 0;
    const LSTATUS found = ::RegEnumValueA(key, index, device, &device_size, nullptr, &type,
                                          reinterpret_cast<BYTE*>(name), &name_size);
    if (found != ERROR_SUCCESS && found != ERROR_MORE_DATA) break;
    if (found != ERROR_SUCCESS || type != REG_SZ) continue;
    name[name_size] = '\0';
    if (number_of(name)) ports.push_back({name, std::string(device, device_size)});
  }
  ::RegCloseKey(key);
  std::ranges::sort(ports, {}, [](const ComPort& port) { return number_of(port.name); });
  return ports;
}

}  // namespace fieldcast::port
