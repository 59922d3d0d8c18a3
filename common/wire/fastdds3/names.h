// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/LibrarySettings.hpp>
#include <fastdds/config.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/flowcontrol/FlowControllerDescriptor.hpp>
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.hpp>
#include <fastdds/rtps/transport/TransportDescriptorInterface.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>

// Names of Fast DDS 3.1, and the calls that 2.9 spells in another way.
namespace coslam {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastdds::rtps;

using eprosima::fastdds::dds::Duration_t;

inline constexpr const char* kMiddlewareVersion = FASTDDS_VERSION_STR;
// Result of take_next_sample() when there was one.
inline constexpr auto kTaken = dds::RETCODE_OK;

// Hands a sample to the writer; false: it could not take it.
inline bool write_sample(dds::DataWriter& writer, const void* sample) {
  return writer.write(sample) == dds::RETCODE_OK;
}

inline void set_heartbeat_period(dds::DataWriterQos& qos, const Duration_t& period) {
  qos.reliable_writer_qos().times.heartbeat_period = period;
}

// Samples are plain CDR, which all versions read; 2.9 reads nothing else.
inline void set_plain_cdr(dds::DataWriterQos& qos) {
  qos.representation().m_value = {dds::DataRepresentationId_t::XCDR_DATA_REPRESENTATION};
}

// A participant with a flow controller announces itself by way of one, and ends at an assert of the middleware (3.1.2,
// in FlowControllerImpl.hpp) when it finds two others at once.
inline constexpr bool kHasSoundFlowControllers = false;

// Participants of one process talk through the network like all others. In force for those made after the first call,
// while there is none yet.
inline void turn_off_intraprocess() {
  eprosima::fastdds::LibrarySettings settings;
  settings.intraprocess_delivery = eprosima::fastdds::INTRAPROCESS_OFF;
  dds::DomainParticipantFactory::get_instance()->set_library_settings(settings);
}

}  // namespace coslam
