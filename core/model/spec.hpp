// The configuration with all defaults. Plain values, created by the loader, which also checks names
// (1..64 of letters, digits, '-', '_', '.').
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/time.hpp"
#include "core/codec/value_codec.hpp"
#include "core/model/port_spec.hpp"
#include "core/program/registration.hpp"
#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

inline constexpr std::size_t kMaxNameLength = 64;

enum class Mode : std::uint8_t {
  kIntensive,  // the bus never idles: the oldest channel is always next
  kScheduled,  // read in time for the refresh; the wire rests otherwise
  kOnDemand,   // only read by command
};
[[nodiscard]] std::string_view to_text(Mode mode);  // "intensive", "scheduled", "on-demand"

// A configuration selects one of the first two; the others only serve comparison.
enum class Planner : std::uint8_t {
  kCyclic,  // the most urgent point, with points that are cheaper to read together
  // The most urgent points with their near neighbours, at most 20 blocks at a time.
  kDynamicBlocks,
  // Fixed groups (the optimal partition), each read at the rate of its fastest member.
  kFastestMember,
  kOnePerChannel,  // every point in a separate read
};
[[nodiscard]] std::string_view to_text(Planner planner);  // "cyclic", "dynamic", ...

enum class Access : std::uint8_t { kReadOnly, kReadWrite, kWriteOnly };
[[nodiscard]] std::string_view to_text(Access access);  // "read-only", ...

// How soon an alarm needs action.
enum class AlarmPriority : std::uint8_t { kLow, kMedium, kHigh, kCritical };
[[nodiscard]] std::string_view to_text(AlarmPriority priority);  // "low", "medium", ...

struct Limits {
  std::optional<double> low_low, low, high, high_high;
  double hysteresis = 0;  // how far a value must be back inside to clear the alarm
  Duration delay{};       // how long it must be outside to raise the alarm
  // Empty: high for low-low and high-high, medium for the others.
  std::optional<AlarmPriority> priority{};
  friend bool operator==(const Limits&, const Limits&) = default;
};

struct ChannelSpec {
  std::string name;
  std::string at;             // as written: "holding:100"
  std::string exponent_from;  // as written, the item of the decimal exponent; empty: none
  Range range;                // as understood, with the item of the exponent
  Encoding encoding;
  Duration refresh = std::chrono::seconds{1};
  Mode mode = Mode::kScheduled;
  Access access = Access::kReadOnly;
  bool on_interest = false;           // `acquire: on-interest`
  int priority = 0;                   // higher values are stretched later under overload; -100..100
  double elasticity = 1;              // its share of a stretch within its priority; 0.1..10
  std::string unit;                   // "°C", up to 32 bytes
  std::string description;            // up to 256 bytes
  std::optional<double> deadband;     // smaller changes are not published
  std::optional<Duration> heartbeat;  // with a deadband: the longest gap; default: the refresh
  Limits limits;
  std::optional<double> write_min, write_max;
  Duration write_interval{};  // rate limit of commands; 0 for none
  friend bool operator==(const ChannelSpec&, const ChannelSpec&) = default;
};

[[nodiscard]] bool read_by_itself(const ChannelSpec& channel);

// The refresh, or the heartbeat with a deadband; empty for channels only read on request.
[[nodiscard]] std::optional<Duration> promised_gap(const ChannelSpec& channel);

struct DeviceSpec {
  std::string name;
  std::string protocol;                     // "modbus-rtu", or the name of a declaration
  declared::SharedDeclaration declaration;  // of a declared protocol
  DeviceLink link;                          // address and protocol options
  // Time from the end of the request to the first byte of a response.
  Duration timeout = std::chrono::milliseconds{200};
  unsigned retries = 1;         // 0..10 more tries of an exchange
  Duration pause{};             // rest after each exchange with this device
  std::uint16_t max_block = 0;  // items in one read; 0: the protocol's limit
  // Unwanted items that a read may bridge; empty: as many as save time.
  std::optional<std::uint16_t> max_gap;
  bool allow_raw_read = false;  // commands to addresses
  bool allow_raw_write = false;
  // Device number for engineers; empty if the device is not programmed through the bridge.
  std::string number;
  std::vector<ChannelSpec> channels;
  friend bool operator==(const DeviceSpec&, const DeviceSpec&) = default;
};

// When a file is full, the next begins and the oldest is deleted.
struct CaptureSpec {
  std::string folder;
  std::uint64_t file_bytes = 10'000'000;
  std::uint32_t files = 10;
  friend bool operator==(const CaptureSpec&, const CaptureSpec&) = default;
};

struct BusSpec {
  std::string name;
  PortSpec port;
  SilenceRule silence;  // between a response and the next request
  // Silence within a response that ends it, in addition to its wire time.
  Duration gap_allowance = std::chrono::milliseconds{20};
  std::optional<bool> echo;  // the line echoes sent bytes; empty: detected
  Planner planner = Planner::kCyclic;
  std::vector<DeviceSpec> devices;
  std::optional<CaptureSpec> capture;  // empty: captured only on request
  // A reload restarts only buses that differ in more than their capture.
  friend bool operator==(const BusSpec&, const BusSpec&) = default;
};

struct DdsSpec {
  std::uint32_t domain = 0;                          // 0..232
  std::vector<std::string> interfaces{"127.0.0.1"};  // IPv4 addresses for DDS
  // "host:port" of Fast DDS discovery servers with identities 0, 1 and so on; all participants list
  // all. Empty: multicast.
  std::vector<std::string> discovery_servers;
  // The user's Fast DDS XML file; its participant profile "fieldcast" is used.
  std::optional<std::string> profile;
  std::optional<std::string> partition;
  std::optional<std::string> security;  // a member's directory, created by `fieldcast secure add`
  bool without_security = false;        // explicitly configured
  std::uint64_t max_rate = 0;           // of outgoing samples, in bytes per second; 0: no limit
  // Limits: participants, endpoints of each, and bytes of a fragmented sample.
  std::uint32_t max_participants = 1024, max_endpoints = 8192, max_sample = 1 << 20;
  friend bool operator==(const DdsSpec&, const DdsSpec&) = default;
};

struct DdsSite {
  std::string name;  // prefix of its bus names: "north:line-7"; empty for the only site
  DdsSpec dds;
  friend bool operator==(const DdsSite&, const DdsSite&) = default;
};

enum class LogLevel : std::uint8_t { kError, kWarning, kInfo, kDebug };
[[nodiscard]] std::string_view to_text(LogLevel level);  // "error", "warning", "info", "debug"

struct LogSpec {
  LogLevel level = LogLevel::kInfo;
  friend bool operator==(const LogSpec&, const LogSpec&) = default;
};

struct StoreSpec {
  std::string address;  // A file, or postgresql://.. (may contain a password: never log it)
  std::vector<std::string> samples{"*"};        // patterns of the channels to store
  Duration keep = std::chrono::hours{30 * 24};  // samples; 0: unlimited
  std::uint64_t max_bytes = 0;  // of a file; then the oldest samples are deleted; 0: no limit
  Duration keep_minutes = std::chrono::hours{365 * 24};  // aggregates per minute; 0: unlimited
  Duration keep_hours = std::chrono::hours{3650 * 24};   // aggregates per hour; 0: unlimited
  friend bool operator==(const StoreSpec&, const StoreSpec&) = default;
};

struct ListenSpec {
  std::string host;  // an IP address
  std::uint16_t port = 0;
  friend bool operator==(const ListenSpec&, const ListenSpec&) = default;
};
[[nodiscard]] bool on_loopback(const ListenSpec& listen);
enum class LoginRule : std::uint8_t { kOffLoopback, kAlways };  // when a login is required
enum class LoginProof : std::uint8_t { kPassword, kCertificate, kEither, kBoth };
// TLS of a listening port; all are paths of PEM files.
struct TlsSpec {
  std::string certificate, key;  // of the bridge; if set, TLS is used
  std::string authority;         // issuer of client certificates; empty: clients need none
  std::string revoked;           // certificate revocation list; empty: none
  friend bool operator==(const TlsSpec&, const TlsSpec&) = default;
};
struct EngineersSpec {
  ListenSpec listen;
  TlsSpec tls;
  LoginRule login = LoginRule::kOffLoopback;
  LoginProof proof = LoginProof::kPassword;
  Duration heartbeat = std::chrono::seconds{5};
  Duration idle = std::chrono::minutes{10};
  // Timeout of TLS and of the request for a device; not a key of the configuration.
  Duration handshake = std::chrono::seconds{10};
  friend bool operator==(const EngineersSpec&, const EngineersSpec&) = default;
};
// Action if a second module connects with the same number.
enum class SecondModule : std::uint8_t { kRefuse, kReplace };
struct ModulesSpec {
  ListenSpec listen;
  program::RegistrationRule registration;
  TlsSpec tls;
  // By common name: device numbers of that certificate. Others may only use their common name.
  std::map<std::string, std::vector<std::string>> subjects;
  std::string secrets;            // path of the modules' secrets; empty: none
  std::vector<std::string> from;  // addresses and networks, "10.0.0.0/8"; empty: any
  SecondModule second = SecondModule::kRefuse;
  bool without_security = false;  // explicitly configured
  friend bool operator==(const ModulesSpec&, const ModulesSpec&) = default;
};
struct ProgramSpec {
  std::optional<EngineersSpec> engineers;
  std::optional<ModulesSpec> modules;
  friend bool operator==(const ProgramSpec&, const ProgramSpec&) = default;
};

// Serves metrics to a scraper (Prometheus), by plain HTTP and without a login.
struct MetricsSpec {
  ListenSpec listen;
  friend bool operator==(const MetricsSpec&, const MetricsSpec&) = default;
};

// Bridges with the same channels that stand by for each other.
struct StandbySpec {
  std::string group;
  std::int32_t strength = 0;  // the strongest ready bridge takes over; 0..1000
  friend bool operator==(const StandbySpec&, const StandbySpec&) = default;
};

struct BridgeSpec {
  std::string name;
  std::optional<StandbySpec> standby;  // empty: a single bridge
  DdsSpec dds;
  LogSpec log;
  ProgramSpec program;
  std::optional<StoreSpec> store;      // empty: samples are not stored
  std::optional<MetricsSpec> metrics;  // empty: metrics are not served
  std::vector<BusSpec> buses;
  friend bool operator==(const BridgeSpec&, const BridgeSpec&) = default;
};

}  // namespace fieldcast
