#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "config/document/document.hpp"
#include "config/document/map_reader.hpp"
#include "config/files/library.hpp"
#include "config/sections/port_text.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::config {

// { serial: PATH, baud, format, rs485, low-latency, exclusive, fence, hold }
//     { tcp: HOST:PORT, baud, format, connect-timeout, fence, hold }
//     { tls: HOST:PORT, authority, certificate, key, revoked, server-name, connect-timeout, fence }
//     { udp: HOST:PORT, baud, format }
//     { rfc2217: HOST:PORT, baud, format, connect-timeout, fence, hold }
//     { dial-in: NUMBER, baud, format }
//
// Without baud and format, the line has the factory setting of the protocol's devices
// (ProtocolEntry::factory_line).
// Of the devices as they leave the factory; the default of LineFormat for unknown protocols.
[[nodiscard]] LineFormat factory_line(std::string_view protocol);

// `factory`: of a line whose keys are missing.
[[nodiscard]] PortSpec read_port(const Node& node, const LineFormat& factory, Library& library,
                                 FaultList& faults);

[[nodiscard]] const RowTable& port_rows();
// "port: { serial: PATH }, { tcp: HOST:PORT } or ..", for faults.
[[nodiscard]] std::string port_forms();

void check_port(const std::string& protocol, const PortSpec& port, const Position& position,
                FaultList& faults);

struct HostPortRule {
  std::string_view port = {};  // proposed if only a host is given; empty: none

  std::optional<std::pair<std::string, std::uint16_t>> operator()(const Node& node,
                                                                  std::string_view key,
                                                                  FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

}  // namespace fieldcast::config
