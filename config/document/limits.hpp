// Limits of a configuration; to exceed one is a fault that names it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"

namespace fieldcast::config {

// Includes do not nest: a bridge names templates and channel lists, a template names channel lists.
inline constexpr std::size_t kMaxFileBytes = 16u << 20;
// Limit of a configuration with all its files.
inline constexpr std::size_t kMaxTotalBytes = 64u << 20;
// Including repetitions by aliases. 100 000 channels with limits and write have 2 300 000.
inline constexpr std::size_t kMaxNodes = 2'400'000;
// Limits of one YAML text. 100 000 channels with limits and write have 300 000 maps.
inline constexpr std::size_t kMaxCollections = 400'000;  // maps and lists
inline constexpr std::size_t kMaxKeys = 1'000;           // of one map
inline constexpr std::size_t kMaxLines = 1'500'000;
inline constexpr std::size_t kMaxNesting = 16;    // of maps and lists; the format needs 8
inline constexpr std::size_t kMaxFaults = 1'000;  // reported together

// Plant:
inline constexpr std::size_t kMaxBuses = 256;
inline constexpr std::size_t kMaxDevices = 247;  // of a bus
// Of a bridge: DeviceStatus has so many instances (kMaxDevices of bridge/dds/topics).
inline constexpr std::size_t kMaxBridgeDevices = 10'000;
inline constexpr unsigned kMaxInFlight = 16;          // requests of a bus
inline constexpr std::size_t kMaxChannels = 100'000;  // of a bridge
inline constexpr std::size_t kMaxInterfaces = 16;
inline constexpr std::size_t kMaxServers = 8;       // discovery servers
inline constexpr std::size_t kMaxSites = 16;        // of a station
inline constexpr std::size_t kMaxOptions = 32;      // of a device
inline constexpr std::size_t kMaxNotAvailable = 8;  // values of a channel's `not-available`

// Texts, in bytes. See core/model/spec.hpp for unit and description.
inline constexpr std::size_t kMaxUnit = 32;
inline constexpr std::size_t kMaxDescription = 256;
inline constexpr std::size_t kMaxExpression = 512;  // of a calculated channel
inline constexpr std::size_t kMaxPath = 1024;
inline constexpr std::size_t kMaxPartition = 256;

// Store:
inline constexpr std::size_t kMaxPatterns = 256;
inline constexpr Duration kMinKeep = std::chrono::hours{1};
inline constexpr Duration kMaxKeep = std::chrono::hours{24 * 36'500};

// Captures:
inline constexpr std::uint32_t kMaxCaptureFiles = 10'000;

// Times:
inline constexpr Duration kMinRefresh = std::chrono::milliseconds{1};
inline constexpr Duration kMaxRefresh = std::chrono::hours{24};
inline constexpr Duration kMinTimeout = std::chrono::milliseconds{1};
inline constexpr Duration kMaxTimeout = std::chrono::minutes{1};
inline constexpr Duration kMaxPause = std::chrono::minutes{1};
inline constexpr Duration kMaxSilence = std::chrono::seconds{10};
inline constexpr double kMaxSilenceCharacters = 1'000;
inline constexpr Duration kMaxAlarmDelay = std::chrono::hours{24};
inline constexpr unsigned kMaxRetries = 10;
inline constexpr int kMaxPriority = 100;
inline constexpr double kMinElasticity = 0.1;
inline constexpr double kMaxElasticity = 10;
inline constexpr int kMaxStrength = 1000;          // in a standby group
inline constexpr unsigned kMaxSecureDomain = 230;  // limit of DDS Security documents
inline constexpr unsigned kMaxDomain = 232;        // DDS: the ports of 233 would exceed 65535

}  // namespace fieldcast::config
