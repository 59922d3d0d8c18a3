// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastcdr/Cdr.h>  // first: other orders are ambiguous in C++20

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/TransportDescriptorInterface.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/config.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/flowcontrol/FlowControllerDescriptor.hpp>

// Names of Fast DDS 2.9, and the calls that 3.1 spells in another way.
namespace coslam {

namespace dds = eprosima::fastdds::dds;

namespace rtps {
using eprosima::fastdds::rtps::ChainingTransport;
using eprosima::fastdds::rtps::ChainingTransportDescriptor;
using eprosima::fastdds::rtps::FlowControllerDescriptor;
using eprosima::fastdds::rtps::FlowControllerSchedulerPolicy;
using eprosima::fastdds::rtps::Locator;
using eprosima::fastdds::rtps::Locators;
using eprosima::fastdds::rtps::LocatorsIterator;
using eprosima::fastdds::rtps::TransportDescriptorInterface;
using eprosima::fastdds::rtps::TransportInterface;
using eprosima::fastdds::rtps::TransportReceiverInterface;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
using eprosima::fastrtps::rtps::GUID_t;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::octet;
using eprosima::fastrtps::rtps::SenderResource;
using eprosima::fastrtps::rtps::SerializedPayload_t;
}  // namespace rtps

using eprosima::fastrtps::Duration_t;

inline constexpr const char* kMiddlewareVersion = FASTRTPS_VERSION_STR;
inline constexpr bool kHasSoundFlowControllers = true;
// Result of take_next_sample() when there was one.
inline constexpr auto kTaken = eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;

// Hands a sample to the writer; false: it could not take it. It asks for a pointer to what may change, and changes
// nothing.
inline bool write_sample(dds::DataWriter& writer, const void* sample) {
  return writer.write(const_cast<void*>(sample));
}

inline void set_heartbeat_period(dds::DataWriterQos& qos, const Duration_t& period) {
  qos.reliable_writer_qos().times.heartbeatPeriod = period;
}

// Samples are plain CDR, which all versions read. This one knows nothing else.
inline void set_plain_cdr(dds::DataWriterQos&) {}

// Participants of one process talk through the network like all others.
inline void turn_off_intraprocess() {
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
}

}  // namespace coslam
