// What a configuration says, with every default filled in: buses, devices, channels. Plain values;
// the loader makes them, everything else reads them. Names are checked by the loader (1..64 of
// letters, digits, '-', '_', '.').
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
  kIntensive,  // the bus never idles: the least fresh channel is always next
  kScheduled,  // read in time for the refresh; then the wire rests
  kOnDemand,   // read only by command
};
[[nodiscard]] std::string_view to_text(Mode mode);  // "intensive", "scheduled", "on-demand"

// How the scheduler forms blocks. A configuration chooses between the first two; the others are
// there to be compared with.
enum class Planner : std::uint8_t {
  kCyclic,  // the most urgent point, and whatever is cheaper to read along with it than later
  // The most urgent point with its near neighbours, again and again, at most 20 blocks; then those
  // are read.
  kDynamicBlocks,
  // Fixed groups (the optimal partition), each read whole as often as its fastest member wants.
  kFastestMember,
  kOnePerChannel,  // every point in a read of its own
};
[[nodiscard]] std::string_view to_text(Planner planner);  // "cyclic", "dynamic", ...

enum class Access : std::uint8_t { kReadOnly, kReadWrite, kWriteOnly };
[[nodiscard]] std::string_view to_text(Access access);  // "read-only", ...

// How soon somebody has to do something about an alarm.
enum class AlarmPriority : std::uint8_t { kLow, kMedium, kHigh, kCritical };
[[nodiscard]] std::string_view to_text(AlarmPriority priority);  // "low", "medium", ...

// Limits on a channel's value; a value beyond one of them raises an alarm.
struct Limits {
  std::optional<double> low_low, low, high, high_high;
  double hysteresis = 0;  // how far a value must be back inside until the alarm is clear
  Duration delay{};       // how long it must be outside until the alarm is raised
  // Of all alarms of the channel; nothing: high for low-low and high-high, medium for the others.
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
  bool on_interest = false;        // acquire: on-interest
  int priority = 0;                // higher is kept fresh longer under overload; -100..100
  double elasticity = 1;           // its share of a stretch beside others of its priority; 0.1..10
  std::string unit;                // "°C", up to 32 bytes
  std::string description;         // up to 256 bytes
  std::optional<double> deadband;  // only changes of more than this are published
  std::optional<Duration> heartbeat;  // with a deadband: the longest gap; default: the refresh
  Limits limits;
  std::optional<double> write_min, write_max;
  Duration write_interval{};  // rate limit of commands; 0 is none
  friend bool operator==(const ChannelSpec&, const ChannelSpec&) = default;
};

// Whether the bridge reads the channel without being asked.
[[nodiscard]] bool read_by_itself(const ChannelSpec& channel);

// The DEADLINE of the channel's samples: its refresh, or with a deadband the heartbeat; nothing for
// channels that are read only when somebody asks.
[[nodiscard]] std::optional<Duration> promised_gap(const ChannelSpec& channel);

struct DeviceSpec {
  std::string name;
  std::string protocol;                     // "modbus-rtu", or the name of a declaration
  declared::SharedDeclaration declaration;  // when the protocol is a declared one
  DeviceLink link;                          // address and protocol options
  // To the first byte of an answer, from the end of the request.
  Duration timeout = std::chrono::milliseconds{200};
  unsigned retries = 1;         // 0..10 more tries of an exchange
  Duration pause{};             // rest after each exchange with this device
  std::uint16_t max_block = 0;  // items in one read; 0 is the protocol's limit
  // Unwanted items that a read may bridge; nothing: whatever pays.
  std::optional<std::uint16_t> max_gap;
  bool allow_raw_read = false;  // commands to addresses
  bool allow_raw_write = false;
  // Under which engineers ask for it; empty: it is not programmed through the bridge.
  std::string number;
  std::vector<ChannelSpec> channels;
  friend bool operator==(const DeviceSpec&, const DeviceSpec&) = default;
};

// Files with what passes on the wire of a bus: when one is full, the next begins, and the oldest
// goes.
struct CaptureSpec {
  std::string folder;
  std::uint64_t file_bytes = 10'000'000;
  std::uint32_t files = 10;
  friend bool operator==(const CaptureSpec&, const CaptureSpec&) = default;
};

struct BusSpec {
  std::string name;
  PortSpec port;
  SilenceRule silence;  // between an answer and the next request
  // Silence inside an answer that ends it, beyond its wire time.
  Duration gap_allowance = std::chrono::milliseconds{20};
  std::optional<bool> echo;  // the line gives back what is sent; nothing: found out
  Planner planner = Planner::kCyclic;
  std::vector<DeviceSpec> devices;
  std::optional<CaptureSpec> capture;  // nothing: it is captured only when somebody asks
  // A reload restarts only the buses that differ in more than their capture.
  friend bool operator==(const BusSpec&, const BusSpec&) = default;
};

struct DdsSpec {
  std::uint32_t domain = 0;                          // 0..232
  std::vector<std::string> interfaces{"127.0.0.1"};  // IPv4 addresses that DDS may use
  // "host:port" of Fast DDS discovery servers; the first one has the identity 0, the second 1. All
  // participants name all of them. Empty: multicast.
  std::vector<std::string> discovery_servers;
  // A Fast DDS XML file of the user; its participant profile "fieldcast" is used.
  std::optional<std::string> profile;
  std::optional<std::string> partition;
  std::optional<std::string> security;  // a member's folder, made by `fieldcast secure add`
  bool without_security = false;        // said in words
  std::uint64_t max_rate = 0;           // of samples on their way out, bytes a second; 0: no bound
  // What is accepted from the network: participants at a time, endpoints of each, and the bytes of
  // a sample that arrives in fragments.
  std::uint32_t max_participants = 1024, max_endpoints = 8192, max_sample = 1 << 20;
  friend bool operator==(const DdsSpec&, const DdsSpec&) = default;
};

// One of several sites that a station watches: a domain, a partition, a discovery server..
struct DdsSite {
  std::string name;  // goes before the names of its buses: "north:line-7"; empty: the only one
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
  std::string address;  // a file, or postgresql://.. (which may hold a password: never for a log)
  std::vector<std::string> samples{"*"};        // patterns of the channels whose samples are stored
  Duration keep = std::chrono::hours{30 * 24};  // samples; 0: for ever
  std::uint64_t max_bytes = 0;  // of a file, then the oldest samples go; 0: no bound
  Duration keep_minutes = std::chrono::hours{365 * 24};  // what each minute was; 0: for ever
  Duration keep_hours = std::chrono::hours{3650 * 24};   // what each hour was; 0: for ever
  friend bool operator==(const StoreSpec&, const StoreSpec&) = default;
};

// Where programming software and the modules that dial in reach the bridge.
struct ListenSpec {
  std::string host;  // an IP address
  std::uint16_t port = 0;
  friend bool operator==(const ListenSpec&, const ListenSpec&) = default;
};
[[nodiscard]] bool on_loopback(const ListenSpec& listen);
enum class LoginRule : std::uint8_t { kOffLoopback, kAlways };  // where a login is demanded
// By what an engineer logs in.
enum class LoginProof : std::uint8_t { kPassword, kCertificate, kEither, kBoth };
// TLS at a port that listens; all are paths of PEM files.
struct TlsSpec {
  std::string certificate, key;  // of the bridge; set: TLS
  std::string authority;         // who signs the certificates of clients; empty: they need none
  std::string revoked;           // a list of those that are not good any more; empty: none
  friend bool operator==(const TlsSpec&, const TlsSpec&) = default;
};
struct EngineersSpec {
  ListenSpec listen;
  TlsSpec tls;
  LoginRule login = LoginRule::kOffLoopback;
  LoginProof proof = LoginProof::kPassword;
  Duration heartbeat = std::chrono::seconds{5};
  Duration idle = std::chrono::minutes{10};
  // For TLS, and for the request for a device. Not a key of the configuration.
  Duration handshake = std::chrono::seconds{10};
  friend bool operator==(const EngineersSpec&, const EngineersSpec&) = default;
};
// A module whose number is that of one that is connected.
enum class SecondModule : std::uint8_t { kRefuse, kReplace };
struct ModulesSpec {
  ListenSpec listen;
  program::RegistrationRule registration;
  TlsSpec tls;
  // Which numbers the certificate with this common name may tell; one that is not named here tells
  // its common name.
  std::map<std::string, std::vector<std::string>> subjects;
  std::string secrets;            // a path: the secrets that modules prove to know; empty: none
  std::vector<std::string> from;  // addresses and networks, "10.0.0.0/8"; empty: any
  SecondModule second = SecondModule::kRefuse;
  bool without_security = false;  // said in words
  friend bool operator==(const ModulesSpec&, const ModulesSpec&) = default;
};
struct ProgramSpec {
  std::optional<EngineersSpec> engineers;
  std::optional<ModulesSpec> modules;
  friend bool operator==(const ProgramSpec&, const ProgramSpec&) = default;
};

// Where a scraper (Prometheus) reads the figures of the bridge, by plain HTTP and without a login.
struct MetricsSpec {
  ListenSpec listen;
  friend bool operator==(const MetricsSpec&, const MetricsSpec&) = default;
};

// Bridges with the same channels that stand by for each other.
struct StandbySpec {
  std::string group;
  std::int32_t strength = 0;  // of those that are ready the strongest takes over; 0..1000
  friend bool operator==(const StandbySpec&, const StandbySpec&) = default;
};

struct BridgeSpec {
  std::string name;
  std::optional<StandbySpec> standby;  // nothing: it stands alone
  DdsSpec dds;
  LogSpec log;
  ProgramSpec program;
  std::optional<StoreSpec> store;      // nothing: nothing is stored
  std::optional<MetricsSpec> metrics;  // nothing: they are served nowhere
  std::vector<BusSpec> buses;
  friend bool operator==(const BridgeSpec&, const BridgeSpec&) = default;
};

}  // namespace fieldcast
