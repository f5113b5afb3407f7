#include "bridge/dds/guard/parameter_list.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "bridge/dds/guard/rtps_cursor.hpp"
#include "bridge/dds/guard/rtps_message.hpp"

namespace fieldcast {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kMostParameters = 256, kMostOfOneLocator = 16;
constexpr std::uint32_t kLongestData = 4096;  // user, topic and group data
constexpr std::uint32_t kInfiniteSeconds = 0x7fffffff, kMostShorts = 8;
constexpr std::uint16_t kSentinel = 0x0001, kPad = 0x0000;

enum class Form : std::uint8_t {
  kFixed,       // exactly `size` bytes
  kText,        // one string
  kTexts,       // a sequence of strings
  kData,        // a sequence of bytes
  kProperties,  // pairs of strings, then perhaps named byte sequences
  kToken,       // a string, then properties
  kDuration,    // 8 bytes, not negative
  kShorts,      // a sequence of 16-bit numbers
  kLocator,     // 24 bytes, several times
  kHidden,      // the library must not parse it
};

struct ParameterRow {
  std::uint16_t id;
  Form form;
  std::uint16_t size = 0;
};

// RTPS 2.2, table 9.12 and 9.14; DDS Security 1.1, 7.4; DDS-XTypes 1.2, 7.6. Sorted by id.
constexpr ParameterRow kRows[] = {
    {0x0002, Form::kDuration},                                // participant lease duration
    {0x0004, Form::kDuration},                                // time-based filter
    {0x0005, Form::kText},                                    // topic name
    {0x0006, Form::kFixed, 4},                                // ownership strength
    {0x0007, Form::kText},                                    // type name
    {0x000b, Form::kFixed, 4},                                // multicast address
    {0x000c, Form::kFixed, 4},                                // default unicast address
    {0x000d, Form::kFixed, 4},                                // metatraffic unicast port
    {0x000e, Form::kFixed, 4},                                // default unicast port
    {0x0011, Form::kFixed, 4},                                // multicast port
    {0x0015, Form::kFixed, 4},                                // protocol version
    {0x0016, Form::kFixed, 4},                                // vendor
    {0x001a, Form::kFixed, 12},                               // reliability
    {0x001b, Form::kFixed, 12},                               // liveliness
    {0x001d, Form::kFixed, 4},                                // durability
    {0x001e, Form::kFixed, 28},                               // durability service
    {0x001f, Form::kFixed, 4},                                // ownership
    {0x0021, Form::kFixed, 8},                                // presentation
    {0x0023, Form::kDuration},                                // deadline
    {0x0025, Form::kFixed, 4},                                // destination order
    {0x0027, Form::kDuration},                                // latency budget
    {0x0029, Form::kTexts},                                   // partition
    {0x002b, Form::kDuration},                                // lifespan
    {0x002c, Form::kData},                                    // user data
    {0x002d, Form::kData},                                    // group data
    {0x002e, Form::kData},                                    // topic data
    {0x002f, Form::kLocator},                                 // unicast
    {0x0030, Form::kLocator},                                 // multicast
    {0x0031, Form::kLocator},                                 // default unicast
    {0x0032, Form::kLocator},                                 // metatraffic unicast
    {0x0033, Form::kLocator},                                 // metatraffic multicast
    {0x0034, Form::kFixed, 4},                                // manual liveliness count
    {0x0035, Form::kHidden},                                  // content filter
    {0x0040, Form::kFixed, 8},                                // history
    {0x0041, Form::kFixed, 12},                               // resource limits
    {0x0043, Form::kFixed, 4},                                // expects inline QoS
    {0x0044, Form::kFixed, 4},                                // built-in endpoints of old
    {0x0045, Form::kFixed, 4},                                // metatraffic unicast address
    {0x0046, Form::kFixed, 4},                                // metatraffic multicast port
    {0x0048, Form::kLocator},                                 // default multicast
    {0x0049, Form::kFixed, 4},                                // transport priority
    {0x0050, Form::kFixed, 16},                               // participant
    {0x0052, Form::kFixed, 16},                               // group
    {0x0053, Form::kFixed, 4},                                // group entity
    {0x0058, Form::kFixed, 4},                                // built-in endpoints
    {0x0059, Form::kProperties}, {0x005a, Form::kFixed, 16},  // endpoint
    {0x0060, Form::kFixed, 4},                                // largest sample
    {0x0062, Form::kText},                                    // entity name
    {0x0069, Form::kHidden},                                  // type identifier
    {0x0070, Form::kFixed, 16},                               // key hash
    {0x0071, Form::kFixed, 4},                                // status
    {0x0072, Form::kHidden},                                  // type object
    {0x0073, Form::kShorts},                                  // data representation
    {0x0074, Form::kFixed, 8},                                // type consistency
    {0x0075, Form::kHidden},                                  // type information
    {0x0083, Form::kFixed, 24},                               // related sample
    {0x1001, Form::kToken},                                   // identity
    {0x1002, Form::kToken},                                   // permissions
    {0x1004, Form::kFixed, 8},                                // security of an endpoint
    {0x1005, Form::kFixed, 8},                                // security of a participant
    {0x1006, Form::kToken},                                   // identity status
    {0x8002, Form::kFixed, 16},                               // Fast DDS: persistence
    {0x8005, Form::kFixed, 4},   // Fast DDS: no positive acknowledgements
    {0x8006, Form::kHidden},     // Fast DDS: data sharing, which Fieldcast turns off
    {0x800f, Form::kFixed, 24},  // Fast DDS: related sample
};

// RTPS 2.2, 9.3.2; the kinds of TCP and shared memory are those of Fast DDS.
bool is_locator(Bytes value, bool little) {
  if (value.size() != 24) return false;
  RtpsCursor in(value, little);
  const std::uint32_t kind = in.u32(), port = in.u32();
  constexpr std::uint32_t kKinds[] = {0, 1, 2, 4, 8, 16, 0xffffffff};
  return port <= 0xffff && std::ranges::count(kKinds, kind) == 1;
}

bool holds(const ParameterRow& row, Bytes value, bool little) {
  RtpsCursor in(value, little);
  switch (row.form) {
    case Form::kFixed: return value.size() == row.size;
    case Form::kText: return cdr_walk::is_text(in, cdr_walk::kLongestText);
    case Form::kData: return cdr_walk::is_data(in, kLongestData);
    case Form::kLocator: return is_locator(value, little);
    case Form::kDuration: return value.size() == 8 && in.u32() <= kInfiniteSeconds;
    case Form::kShorts: {
      const std::uint32_t count = in.u32();
      return in.good() && count <= kMostShorts && 2 * count <= in.left();
    }
    case Form::kProperties: return cdr_walk::are_properties(in);
    case Form::kToken: return cdr_walk::is_token(in);
    case Form::kHidden: return true;
    case Form::kTexts: return cdr_walk::are_texts(in);
  }
  return false;
}

const ParameterRow* row_of(std::uint16_t id) {
  const auto* found = std::ranges::lower_bound(kRows, id, {}, &ParameterRow::id);
  return found != std::end(kRows) && found->id == id ? found : nullptr;
}

void note(std::uint16_t id, Bytes value, bool little, ParameterFacts& facts) {
  if (id == 0x0002) facts.lease_seconds = RtpsCursor(value, little).u32();
  if (id == 0x0031 || id == 0x0032) facts.addresses.push_back(value.subspan(8));
  if (id == 0x0050) facts.participant_guid = value;
  if (id == 0x005a) facts.endpoint_guid = value;
  if (id == 0x0070) facts.key_hash = value;
  if (id == 0x0071) facts.status = value[3];
}

}  // namespace

std::optional<RtpsFault> check_parameters(Bytes list, bool little, ParameterFacts& facts) {
  RtpsCursor in(list, little);
  std::array<std::uint8_t, std::size(kRows)> seen{};
  for (std::size_t n = 0; n < kMostParameters; ++n) {
    const std::size_t begin = in.at();
    const std::uint16_t id = in.u16(), size = in.u16();
    if (!in.good()) return RtpsFault::kParameterList;
    if (id == kSentinel) {
      facts.size = in.at();
      return std::nullopt;
    }
    const Bytes value = in.take(size);
    if (!in.good() || size % 4 != 0) return RtpsFault::kParameterList;
    const ParameterRow* row = id == kPad ? nullptr : row_of(id);
    if (row == nullptr) continue;
    if (!holds(*row, value, little)) return RtpsFault::kParameter;
    auto& times = seen[static_cast<std::size_t>(row - kRows)];
    if (++times > (row->form == Form::kLocator ? kMostOfOneLocator : 1))
      return RtpsFault::kParameter;
    if (row->form == Form::kHidden) facts.hidden.push_back(begin);
    note(id, value, little, facts);
  }
  return RtpsFault::kParameterList;
}

namespace {

class NoteBytes {
 public:
  explicit NoteBytes(const ParticipantPrefix& prefix) : bytes_{'R', 'T', 'P', 'S', 2, 2, 1, 15} {
    add(prefix);
  }
  void add(std::initializer_list<std::uint8_t> more) {
    bytes_.insert(bytes_.end(), more.begin(), more.end());
  }
  template <std::size_t size>
  void add(const std::array<std::uint8_t, size>& more) {
    bytes_.insert(bytes_.end(), more.begin(), more.end());
  }
  void add_number(std::uint64_t number) {  // RTPS 2.2, 9.3.2: the upper half is first
    add_little(static_cast<std::uint32_t>(number >> 32));
    add_little(static_cast<std::uint32_t>(number));
  }
  void add_little(std::uint32_t value) {
    for (int i = 0; i < 4; ++i) bytes_.push_back(static_cast<std::uint8_t>(value >> 8 * i));
  }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

constexpr std::uint8_t kHasKeys = 2, kWantsNoResponse = 2;
constexpr std::uint32_t kOurCount = 0x7fffffff;  // higher than the count of any writer

void add_heartbeat(NoteBytes& message, std::uint64_t number) {
  message.add({static_cast<std::uint8_t>(Submessage::kHeartbeat),
               kLittleEndianFlag | kWantsNoResponse, 28, 0});
  message.add(kParticipantReader);
  message.add(kParticipantWriter);
  message.add_number(number);  // the first number that it has, and the last
  message.add_number(number);
  message.add_little(kOurCount);
}

void add_end(NoteBytes& message, const ParticipantPrefix& of, std::uint64_t number) {
  message.add({static_cast<std::uint8_t>(Submessage::kData), kLittleEndianFlag | kHasKeys, 52, 0});
  message.add({0, 0, 16, 0});
  message.add(kParticipantReader);
  message.add(kParticipantWriter);
  message.add_number(number);
  message.add({0x70, 0, 16, 0});  // the key: the GUID
  message.add(of);
  message.add({0, 0, 1, 0xc1});
  message.add({0x71, 0, 4, 0, 0, 0, 0, 3});  // disposed and unregistered
  message.add({1, 0, 0, 0});
}

}  // namespace

std::vector<std::uint8_t> participant_gone(const ParticipantPrefix& prefix, std::uint64_t number) {
  NoteBytes message(prefix);
  add_end(message, prefix, number);
  return message.take();
}

std::vector<std::uint8_t> participants_gone(std::span<const ParticipantPrefix> others,
                                            const ParticipantPrefix& server, std::uint64_t number) {
  NoteBytes message(server);
  add_heartbeat(message, number);
  for (const ParticipantPrefix& other : others) add_end(message, other, number++);
  add_end(message, server, number);
  return message.take();
}

}  // namespace fieldcast
