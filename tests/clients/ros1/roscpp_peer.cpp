// A peer of the matrix in roscpp: roscpp_peer NAME PEERS SERVING MESSAGES, where MESSAGES are
// KIND=HEX for each kind.

#include <condition_variable>
#include <iomanip>
#include <iostream>
#include <map>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include <actionlib/TestAction.h>
#include <actionlib/client/simple_action_client.h>
#include <actionlib/server/simple_action_server.h>
#include <ros/ros.h>
#include <sensor_msgs/CompressedImage.h>
#include <std_msgs/Float64MultiArray.h>
#include <std_msgs/Int64MultiArray.h>
#include <std_srvs/SetBool.h>

namespace ser = ros::serialization;
using actionlib::TestAction;

std::string name;
std::map<std::string, std::string> hex_of_kind;
std::vector<ros::Subscriber> subscribers;
std::vector<std::function<void()>> publish_all;

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

void saw(const std::string& what, const std::string& peer, const std::string& value) {
  static std::mutex mutex;
  std::lock_guard<std::mutex> lock(mutex);
  std::cout << "{\"saw\": \"" << what << "\", \"of\": \"" << peer << "\", \"value\": " << value
            << "}" << std::endl;
}

template <class M>
M message(const std::string& kind) {
  const std::string& hex = hex_of_kind[kind];
  std::vector<uint8_t> bytes;
  for (size_t i = 0; i < hex.size(); i += 2)
    bytes.push_back(std::stoi(hex.substr(i, 2), nullptr, 16));
  M found;
  ser::IStream stream(bytes.data(), bytes.size());
  ser::deserialize(stream, found);
  return found;
}

template <class M>
void hear(ros::NodeHandle& node, const std::string& what, const std::string& peer,
          const std::string& kind) {
  auto heard = std::make_shared<bool>(false);
  boost::function<void(const boost::shared_ptr<M const>&)> take =
      [=](const boost::shared_ptr<M const>& found) {
        if (*heard) return;
        *heard = true;
        std::vector<uint8_t> bytes(ser::serializationLength(*found));
        ser::OStream stream(bytes.data(), bytes.size());
        ser::serialize(stream, *found);
        std::ostringstream hex;
        hex << '"' << std::hex << std::setfill('0');
        for (uint8_t byte : bytes) hex << std::setw(2) << int(byte);
        saw(what + " " + kind, peer, hex.str() + "\"");
      };
  subscribers.push_back(node.subscribe<M>("/" + peer + "/" + what + "/" + kind, 1, take));
}

template <class M>
void exchange(ros::NodeHandle& node, const std::vector<std::string>& peers,
              const std::string& kind) {
  for (const auto& peer : peers) {
    hear<M>(node, "latched", peer, kind);
    hear<M>(node, "plain", peer, kind);
  }
}

template <class M>
void advertise(ros::NodeHandle& node, const std::string& kind) {
  static std::vector<ros::Publisher> publishers;
  publishers.push_back(node.advertise<M>("/" + name + "/latched/" + kind, 1, true));
  publishers.back().publish(message<M>(kind));
  publishers.push_back(node.advertise<M>("/" + name + "/plain/" + kind, 1));
  ros::Publisher plain = publishers.back();
  publish_all.push_back([=] { plain.publish(message<M>(kind)); });
}

std::string json(XmlRpc::XmlRpcValue& value) {
  std::ostringstream text;
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeStruct: {
      text << '{';
      for (auto each = value.begin(); each != value.end(); ++each)
        text << (each == value.begin() ? "" : ", ") << '"' << each->first
             << "\": " << json(each->second);
      text << '}';
      break;
    }
    case XmlRpc::XmlRpcValue::TypeArray:
      text << '[';
      for (int i = 0; i < value.size(); ++i) text << (i ? ", " : "") << json(value[i]);
      text << ']';
      break;
    case XmlRpc::XmlRpcValue::TypeString:
      text << '"' << std::string(value) << '"';
      break;
    case XmlRpc::XmlRpcValue::TypeBoolean:
      text << (bool(value) ? "true" : "false");
      break;
    case XmlRpc::XmlRpcValue::TypeDouble:
      text << double(value);
      break;
    default:
      text << int(value);
  }
  return text.str();
}

bool answer(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
  response.success = true;
  response.message = "from " + name + ", \u00e4";
  return request.data;
}

void call(ros::NodeHandle node, const std::string& peer) {
  auto client = node.serviceClient<std_srvs::SetBool>("/" + peer + "/set_bool");
  client.waitForExistence();
  std_srvs::SetBool service;
  service.request.data = true;
  if (client.call(service))
    saw("service", peer,
        std::string(service.response.success ? "[true, \"" : "[false, \"") +
            service.response.message + "\"]");
  service.request.data = false;
  if (!client.call(service)) saw("refusal", peer, "null");
}

// Lets the server finish its goal once a line of standard input says so.
class Finish {
 public:
  void clear() {
    std::lock_guard<std::mutex> lock(mutex_);
    is_set_ = false;
  }

  void set() {
    std::lock_guard<std::mutex> lock(mutex_);
    is_set_ = true;
    changed_.notify_all();
  }

  void wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return is_set_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_set_ = false;
} finish;

// The patience with a goal, which ROS's own actionlib may lose.
const double GOAL_SECONDS = 10;

void act(const std::string& peer) {
  actionlib::SimpleActionClient<TestAction> client("/" + peer + "/act", false);
  client.waitForServer();
  actionlib::TestGoal goal;
  goal.goal = 21;
  std::ostringstream feedback;
  client.sendGoal(goal, {}, {}, [&](const actionlib::TestFeedbackConstPtr& each) {
    feedback << (feedback.tellp() > 0 ? ", " : "") << each->feedback;
    saw("feedback", peer, std::to_string(each->feedback));
  });
  if (!client.waitForResult(ros::Duration(GOAL_SECONDS))) return;  // See LOSING.
  saw("action", peer,
      "[[" + feedback.str() + "], " + std::to_string(client.getResult()->result) + "]");
}

int main(int argc, char** argv) {
  name = argv[1];
  for (int i = 4; i < argc; ++i) {
    std::string given = argv[i];
    size_t equals = given.find('=');
    hex_of_kind[given.substr(0, equals)] = given.substr(equals + 1);
  }
  int no_arguments = 0;
  ros::init(no_arguments, argv, name);
  ros::NodeHandle node;
  advertise<std_msgs::Int64MultiArray>(node, "ints");
  advertise<std_msgs::Float64MultiArray>(node, "floats");
  advertise<sensor_msgs::CompressedImage>(node, "image");

  XmlRpc::XmlRpcValue parameters, list;
  list.setSize(3);
  list[0] = 1;
  list[1] = 2.5;
  list[2] = "x";
  parameters["flag"] = true;
  parameters["float"] = 0.5;
  parameters["int"] = 7;
  parameters["list"] = list;
  parameters["text"] = "\u00e4";
  node.setParam("/parameters/" + name, parameters);

  ros::ServiceServer service = node.advertiseService("/" + name + "/set_bool", answer);
  std::unique_ptr<actionlib::SimpleActionServer<TestAction>> server;
  server.reset(new actionlib::SimpleActionServer<TestAction>(
      "/" + name + "/act",
      [&](const actionlib::TestGoalConstPtr& goal) {
        finish.clear();
        actionlib::TestFeedback feedback;
        feedback.feedback = goal->goal;
        server->publishFeedback(feedback);
        finish.wait();  // Feedback and result come on two connections, in any order.
        actionlib::TestResult result;
        result.result = 2 * goal->goal;
        server->setSucceeded(result);
      },
      false));
  server->start();
  ros::AsyncSpinner spinner(4);
  spinner.start();
  std::cout << "ready" << std::endl;
  std::string line;
  std::getline(std::cin, line);

  std::vector<std::string> peers = split(argv[2]);
  exchange<std_msgs::Int64MultiArray>(node, peers, "ints");
  exchange<std_msgs::Float64MultiArray>(node, peers, "floats");
  exchange<sensor_msgs::CompressedImage>(node, peers, "image");
  for (const auto& peer : peers) {
    XmlRpc::XmlRpcValue found;
    if (node.getParam("/parameters/" + peer, found)) saw("parameters", peer, json(found));
  }
  for (const auto& peer : split(argv[3])) std::thread(call, node, peer).detach();
  std::thread([] {
    for (std::string line; std::getline(std::cin, line);) {
      if (line == "finish")
        finish.set();
      else
        std::thread(act, line).detach();
    }
  }).detach();
  for (ros::Rate rate(10); ros::ok(); rate.sleep())
    for (auto& publish : publish_all) publish();
}
