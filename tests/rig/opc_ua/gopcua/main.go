// A client made of gopcua that does what it is told, a line of JSON each, and answers each.
package main

import (
	"bufio"
	"context"
	"crypto/rsa"
	"crypto/x509"
	"encoding/json"
	"encoding/pem"
	"fmt"
	"os"
	"strings"
	"sync"
	"time"

	"github.com/gopcua/opcua"
	"github.com/gopcua/opcua/ua"
)

type command struct {
	Doing, Policy, Mode, User, Password, Own string
	Tag, Property, Type                      string
	Value                                    any
	Deadband                                 float64
}

type client struct {
	address, certificate, key, server string
	connected                         *opcua.Client
	namespace                         uint16
	subscription                      *opcua.Subscription
	lock                              sync.Mutex
	tags                              []string
	told                              map[string][][2]any
}

func name(code ua.StatusCode) string {
	if code == ua.StatusOK {
		return "Good"
	}
	if known, ok := ua.StatusCodes[code]; ok {
		return strings.ReplaceAll(known.Name[len("Status"):], "ID", "Id")
	}
	return fmt.Sprintf("0x%08X", uint32(code))
}

func (c *client) node(tag string) *ua.NodeID {
	return ua.NewStringNodeID(c.namespace, tag)
}

func (c *client) do(ctx context.Context, given command) (any, error) {
	switch given.Doing {
	case "open":
		return c.open(ctx, given)
	case "read":
		return c.read(ctx, given)
	case "write":
		return c.write(ctx, given)
	case "browse":
		return c.browse(ctx, given)
	case "watch":
		return c.watch(ctx, given)
	case "told":
		c.lock.Lock()
		defer c.lock.Unlock()
		return append([][2]any{}, c.told[given.Tag]...), nil
	case "close":
		return "closed", c.connected.Close(ctx)
	}
	return nil, fmt.Errorf("unknown: %s", given.Doing)
}

func (c *client) open(ctx context.Context, given command) (any, error) {
	server, err := os.ReadFile(c.server)
	if err != nil {
		return nil, err
	}
	key, err := privateKey(c.key)
	if err != nil {
		return nil, err
	}
	endpoints, err := opcua.GetEndpoints(ctx, c.address)
	if err != nil {
		return nil, err
	}
	endpoint, err := opcua.SelectEndpoint(
		endpoints, given.Policy, ua.MessageSecurityModeFromString(given.Mode))
	if err != nil {
		return nil, err
	}
	c.connected, err = opcua.NewClient(c.address,
		opcua.AutoReconnect(false), opcua.ApplicationURI(given.Own),
		opcua.CertificateFile(c.certificate), opcua.PrivateKey(key),
		opcua.RemoteCertificate(server),
		opcua.AuthUsername(given.User, given.Password),
		opcua.SecurityFromEndpoint(endpoint, ua.UserTokenTypeUserName))
	if err != nil {
		return nil, err
	}
	if err = c.connected.Connect(ctx); err != nil {
		return nil, err
	}
	index, err := c.connected.FindNamespace(ctx, "urn:clepsydra:rig")
	c.namespace = index
	return index, err
}

// gopcua reads keys of PKCS #1 alone.
func privateKey(file string) (*rsa.PrivateKey, error) {
	text, err := os.ReadFile(file)
	if err != nil {
		return nil, err
	}
	block, _ := pem.Decode(text)
	found, err := x509.ParsePKCS8PrivateKey(block.Bytes)
	if err != nil {
		return nil, err
	}
	return found.(*rsa.PrivateKey), nil
}

func (c *client) read(ctx context.Context, given command) (any, error) {
	tag := given.Tag
	if given.Property != "" {
		tag += "/" + given.Property
	}
	answer, err := c.connected.Read(ctx, &ua.ReadRequest{
		TimestampsToReturn: ua.TimestampsToReturnBoth,
		NodesToRead:        []*ua.ReadValueID{{NodeID: c.node(tag), AttributeID: ua.AttributeIDValue}},
	})
	if err != nil {
		return nil, err
	}
	found := answer.Results[0]
	return map[string]any{
		"value": plain(found.Value), "status": name(found.Status),
		"time": float64(found.SourceTimestamp.UnixMilli()) / 1000,
	}, nil
}

func plain(value *ua.Variant) any {
	if value == nil {
		return nil
	}
	if object, ok := value.Value().(*ua.ExtensionObject); ok {
		if span, ok := object.Value.(*ua.Range); ok {
			return map[string]float64{"low": span.Low, "high": span.High}
		}
	}
	return value.Value()
}

func (c *client) write(ctx context.Context, given command) (any, error) {
	var value any
	number, _ := given.Value.(float64)
	switch given.Type {
	case "Double":
		value = number
	case "UInt16":
		value = uint16(number)
	case "Int32":
		value = int32(number)
	case "Boolean":
		value = given.Value
	}
	variant, err := ua.NewVariant(value)
	if err != nil {
		return nil, err
	}
	answer, err := c.connected.Write(ctx, &ua.WriteRequest{NodesToWrite: []*ua.WriteValue{{
		NodeID: c.node(given.Tag), AttributeID: ua.AttributeIDValue,
		Value: &ua.DataValue{EncodingMask: ua.DataValueValue, Value: variant},
	}}})
	if err != nil {
		return nil, err
	}
	return name(answer.Results[0]), nil
}

func (c *client) browse(ctx context.Context, given command) (any, error) {
	folder := c.connected.Node(c.node("/" + given.Tag))
	children, err := folder.Children(ctx, 0, ua.NodeClassAll)
	if err != nil {
		return nil, err
	}
	names := []string{}
	for _, child := range children {
		found, err := child.BrowseName(ctx)
		if err != nil {
			return nil, err
		}
		names = append(names, found.Name)
	}
	return names, nil
}

func (c *client) watch(ctx context.Context, given command) (any, error) {
	if c.subscription == nil {
		news := make(chan *opcua.PublishNotificationData, 100)
		made, err := c.connected.Subscribe(ctx, &opcua.SubscriptionParameters{
			Interval: 20 * time.Millisecond, LifetimeCount: 1000, MaxKeepAliveCount: 10,
		}, news)
		if err != nil {
			return nil, err
		}
		c.subscription = made
		go c.hear(news)
	}
	handle := uint32(len(c.tags))
	c.lock.Lock()
	c.tags = append(c.tags, given.Tag)
	c.told[given.Tag] = nil
	c.lock.Unlock()
	wanted := opcua.NewMonitoredItemCreateRequestWithDefaults(
		c.node(given.Tag), ua.AttributeIDValue, handle)
	wanted.RequestedParameters.SamplingInterval = 0
	wanted.RequestedParameters.QueueSize = 100
	kinds := map[string]uint32{"Absolute": 1, "Percent": 2}
	if kind, ok := kinds[given.Type]; ok {
		wanted.RequestedParameters.Filter = ua.NewExtensionObject(&ua.DataChangeFilter{
			Trigger:      ua.DataChangeTriggerStatusValue,
			DeadbandType: kind, DeadbandValue: given.Deadband,
		})
	}
	answer, err := c.subscription.Monitor(ctx, ua.TimestampsToReturnBoth, wanted)
	if err != nil {
		return nil, err
	}
	return name(answer.Results[0].StatusCode), nil
}

func (c *client) hear(news chan *opcua.PublishNotificationData) {
	for each := range news {
		changes, ok := each.Value.(*ua.DataChangeNotification)
		if !ok {
			continue
		}
		c.lock.Lock()
		for _, item := range changes.MonitoredItems {
			tag := c.tags[item.ClientHandle]
			c.told[tag] = append(c.told[tag], [2]any{plain(item.Value.Value), name(item.Value.Status)})
		}
		c.lock.Unlock()
	}
}

func main() {
	ctx := context.Background()
	c := &client{
		address: os.Args[1], certificate: os.Args[2], key: os.Args[3], server: os.Args[4],
		told: map[string][][2]any{},
	}
	lines := bufio.NewScanner(os.Stdin)
	for lines.Scan() {
		var given command
		answer := map[string]any{}
		err := json.Unmarshal(lines.Bytes(), &given)
		if err == nil {
			answer["found"], err = c.do(ctx, given)
		}
		if err != nil {
			answer = map[string]any{"error": err.Error()}
		}
		text, err := json.Marshal(answer)
		if err != nil {
			text = []byte(`{"error": "no JSON"}`)
		}
		fmt.Printf("@%s\n", text)
		if given.Doing == "close" {
			return
		}
	}
}
