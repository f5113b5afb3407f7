// Names and QoS of the topics, in one place for both ends (design, section 4).
//
// Every keyed endpoint gets resource limits of its own: the library's default is 10 instances, and
// of 100 channels 90 would vanish without a word.
#pragma once

#include <cstdint>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <optional>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast {

namespace dds = eprosima::fastdds::dds;
using DdsDuration = eprosima::fastrtps::Duration_t;

inline constexpr const char* kSampleTopic = "fieldcast/Sample";
inline constexpr const char* kChannelTopic = "fieldcast/Channel";
inline constexpr const char* kCommandTopic = "fieldcast/Command";
inline constexpr const char* kCommandResultTopic = "fieldcast/CommandResult";
inline constexpr const char* kInterestTopic = "fieldcast/Interest";
inline constexpr const char* kBusStatusTopic = "fieldcast/BusStatus";
inline constexpr const char* kDeviceStatusTopic = "fieldcast/DeviceStatus";
inline constexpr const char* kProgramSessionTopic = "fieldcast/ProgramSession";
inline constexpr const char* kAlarmTopic = "fieldcast/Alarm";
inline constexpr const char* kBridgeTopic = "fieldcast/Bridge";

inline constexpr std::int32_t kChannelsPerWriter =
    256;  // DEADLINE costs a scan over a writer's instances at nearly every write
inline constexpr std::int32_t kMaxChannels =
    100'000;  // in the domain, at one reader; and in the catalogue of one bridge
inline constexpr std::int32_t kMaxDevices = 10'000;  // the same for status
inline constexpr std::int32_t kMaxAlarms = 100'000;  // limits that were ever passed, the same
inline constexpr std::int32_t kMaxPendingCommands =
    4096;  // commands not yet acknowledged, commands and results not yet taken
inline constexpr std::int32_t kMaxResults =
    2 * kMaxPendingCommands;  // and notes of their instances that some reader does not have yet
inline constexpr std::int32_t kMaxInterests = 4096;
inline constexpr std::int32_t kMaxBridges = 1024;
inline constexpr std::int32_t kMaxBuses = 1024;  // of one bridge

[[nodiscard]] DdsDuration to_dds(Duration duration);
[[nodiscard]] Duration from_dds(const DdsDuration& duration);  // kInfinite for an infinite one
inline constexpr Duration kInfinite = Duration::max();

// Last value of each instance, kept for late joiners: catalogue and status. Unregistering an
// instance disposes it.
[[nodiscard]] dds::DataWriterQos state_writer_qos(std::int32_t max_instances);
[[nodiscard]] dds::DataReaderQos state_reader_qos(std::int32_t max_instances);

// Samples of one refresh class; nothing: no promise.
[[nodiscard]] dds::DataWriterQos sample_writer_qos(std::optional<Duration> refresh);
[[nodiscard]] dds::DataReaderQos sample_reader_qos(std::optional<Duration> deadline);

// Commands and results: volatile, and no instance kept afterwards.
[[nodiscard]] dds::DataWriterQos command_writer_qos(
    Duration lifespan);  // waits up to a second for readers that lag
[[nodiscard]] dds::DataWriterQos
result_writer_qos();  // never waits for a reader: one that stays behind loses the oldest
[[nodiscard]] dds::DataReaderQos request_reader_qos();

// The lease of what says that its process is alive.
inline constexpr Duration kLease = std::chrono::seconds{6};

// The station's writer promises to be alive; the bridge's reader asks for nothing, so that any
// vendor's default QoS is heard.
[[nodiscard]] dds::DataWriterQos interest_writer_qos();
[[nodiscard]] dds::DataReaderQos interest_reader_qos();
// Of a reader that takes nothing and hears which of the writers that promise the lease are alive.
[[nodiscard]] dds::DataReaderQos lease_reader_qos();

// Bridges among themselves: both ends promise and ask for the lease within which a dead one is
// noticed.
[[nodiscard]] dds::DataWriterQos bridge_writer_qos();
[[nodiscard]] dds::DataReaderQos bridge_reader_qos();

}  // namespace fieldcast
