//! What a page says to the console and asks of a network.

use std::sync::{Arc, Mutex};

use headless_chrome::Tab;
use headless_chrome::protocol::cdp::Network;
use headless_chrome::protocol::cdp::types::Event;

/// What was said so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct Said {
    /// Messages of the console, errors, refused loads.
    console: Arc<Mutex<Vec<String>>>,
    /// Addresses asked for.
    requests: Arc<Mutex<Vec<String>>>,
}

impl Said {
    /// Listens to a page from now on.
    pub(crate) fn of(tab: &Tab) -> Self {
        let said = Self::default();
        let heard = said.clone();
        let listener = Arc::new(move |event: &Event| heard.note(event));
        tab.add_event_listener(listener).unwrap_or_else(|error| panic!("the page cannot be listened to: {error}"));
        tab.enable_runtime().and_then(|tab| tab.enable_log()).unwrap_or_else(|error| panic!("no console: {error}"));
        let network = Network::Enable {
            max_total_buffer_size: None,
            max_resource_buffer_size: None,
            max_post_data_size: None,
            report_direct_socket_traffic: None,
            enable_durable_messages: None,
        };
        tab.call_method(network).unwrap_or_else(|error| panic!("no requests: {error}"));
        said
    }

    fn note(&self, event: &Event) {
        let add = |list: &Mutex<Vec<String>>, text: String| {
            if let Ok(mut list) = list.lock() {
                list.push(text);
            }
        };
        match event {
            Event::RuntimeConsoleAPICalled(call) => {
                let texts = call.params.args.iter().map(|a| a.value.clone().unwrap_or_default().to_string());
                add(&self.console, texts.collect::<Vec<_>>().join(" "));
            }
            Event::RuntimeExceptionThrown(thrown) => {
                let details = &thrown.params.exception_details;
                let text = details.exception.as_ref().and_then(|e| e.description.clone());
                add(&self.console, text.unwrap_or_else(|| details.text.clone()));
            }
            Event::LogEntryAdded(added) => add(&self.console, added.params.entry.text.clone()),
            Event::NetworkRequestWillBeSent(sent) => add(&self.requests, sent.params.request.url.clone()),
            _ => {}
        }
    }

    /// Messages of the console, errors and refused loads.
    pub(crate) fn console(&self) -> Vec<String> {
        self.console.lock().map(|list| list.clone()).unwrap_or_default()
    }

    /// Addresses asked for, the page's own first.
    pub(crate) fn requests(&self) -> Vec<String> {
        self.requests.lock().map(|list| list.clone()).unwrap_or_default()
    }
}
