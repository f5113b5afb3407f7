/* Helpers of stations in C on Cyclone DDS, in addition to the types that idlc generates from
 * fieldcast.idl: the QoS of the topics. One thread. A failure ends the program with a message,
 * because these programs are examples and test peers. */
#pragma once

#include <stdbool.h>

#include "dds/dds.h"
#include "fieldcast.h"

/* Returns the entity; ends the program if it is an error. */
dds_entity_t need(dds_entity_t entity, const char* what);

dds_entity_t participant_in(const char* domain);

/* Reader and writer of a topic; `name` is the topic's. */
dds_entity_t reader_of(dds_entity_t participant, const dds_topic_descriptor_t* type,
                       const char* name, const dds_qos_t* qos);
dds_entity_t writer_of(dds_entity_t participant, const dds_topic_descriptor_t* type,
                       const char* name, const dds_qos_t* qos);

/* Makes the zeroed `command` a write of `value` to the channel { bus, device, channel } of `names`,
 * with a requester that is unique for each process. It refers to `value`. */
void set_write(fieldcast_Command* command, char** names, fieldcast_Value* value);

/* Reliable, transient-local, keep last 1: Sample, Channel, BusStatus, DeviceStatus. A deadline
 * above 0 matches only writers that offer it or a shorter one. The caller deletes it with
 * dds_delete_qos. */
dds_qos_t* state_qos(dds_duration_t deadline);

/* Reliable, volatile, keep all: Command and CommandResult. */
dds_qos_t* request_qos(void);

/* Waits until both ends are matched. Results are volatile: a command that is written before the
 * bridge has matched the result reader may miss its result. */
bool matched(dds_entity_t writer, dds_entity_t reader, dds_time_t until);

const char* quality_name(fieldcast_Quality quality);
const char* state_name(fieldcast_CommandState state);
const char* kind_name(fieldcast_ValueKind kind);
void print_value(const fieldcast_Value* value);

/* Returns true after SIGTERM or SIGINT; the first call installs the handlers. */
bool stopped(void);
