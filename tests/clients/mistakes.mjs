/** What goes wrong in pages, one mistake after the other. */

/** Makes the mistakes on a connection; none of them is caught by the page. */
export async function makeMistakes({ library, settled }, ros) {
  const topic = (name, messageType, options) =>
    new library.Topic({ ros, name, messageType, ...options });
  const call = (name, serviceType, request) =>
    new library.Service({ ros, name, serviceType }).callService(
      request,
      () => {},
      console.error,
    );

  const chatter = topic("/chatter", "std_msgs/String");
  chatter.publish({ dta: "a misspelled field" });
  chatter.publish({ data: 5 });
  chatter.publish("a value in place of a message");
  topic("/chatter", "std_msgs/Int32").advertise();
  topic("/chatter", "std_msgs/Int32").subscribe(() => {});
  topic("/misspelled_package", "std_msg/String").publish({ data: "" });
  topic("/misspelled_type", "std_msgs/Sting").publish({ data: "" });
  topic("/a name", "std_msgs/String").publish({ data: "" });
  topic("/throttled", "std_msgs/String", { throttle_rate: "fast" }).subscribe(() => {});
  call("/rosapi/get_parm", "rosapi/GetParam", { name: "/a" });
  call("/rosapi/get_param", "rosapi/GetParam", { nam: "/a" });
  const reset = new library.Service({ ros, name: "/reset", serviceType: "std_srvs/Emty" });
  await reset.advertise(() => true);
  await settled(ros);
}
